"""The history of benchmarks: what was worse by more than noise, and a file that reads back equal."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from bench import figures, history
from bench.figures import Figure, exact, note, of_rounds
from bench.history import COLUMNS, Change, Entry, Run, append, changes, machine, read, table

HERE, THERE = Run("2026-01-02", "abc", "Quick CPU, 2 cores"), Run("2026-01-01", "def", "Slow CPU, 4 cores")
NOISY = of_rounds("ratio", [1.9, 2.0, 2.1], "times")


def slid(now: Figure, before: Figure) -> bool:
    return Change(now, Entry(HERE, before)).slid


def test_an_exact_count_slides_by_one_and_a_noisy_one_beyond_its_rounds_only() -> None:
    assert slid(exact("flash", 101, "bytes"), exact("flash", 100, "bytes"))
    assert not slid(exact("flash", 99, "bytes"), exact("flash", 100, "bytes"))
    assert slid(exact("lost", 1, "frames"), exact("lost", 0, "frames"))
    assert not slid(Figure("ratio", 1.81, "times", 0.0001, True), NOISY)
    assert slid(Figure("ratio", 1.79, "times", 0.0001, True), NOISY)
    assert not slid(Figure("ratio", 1.5, "times", 0.3, True), NOISY)
    assert not slid(Figure("ratio", 3.0, "times", 0.0001, True), NOISY)
    assert not Change(NOISY, None).slid


def test_noisy_figures_are_compared_on_one_machine_and_exact_ones_on_any() -> None:
    flash = exact("flash", 100, "bytes")
    kept = [Entry(HERE, NOISY), Entry(THERE, NOISY), Entry(THERE, flash)]
    assert changes([NOISY, flash], kept, HERE.machine) == [
        Change(NOISY, kept[0]),
        Change(flash, kept[2]),
    ]
    assert changes([exact("new", 1, "bytes")], kept, HERE.machine)[0].last is None


names = st.text(st.characters(exclude_categories=["Cs", "Cc"]), min_size=1)
values = st.integers(0, 10**11).map(float)
written = st.builds(Figure, names, values, names, st.just(0.0), st.booleans())
runs = st.builds(Run, st.dates().map(str), names, names)


@given(st.lists(st.tuples(runs, st.lists(written, min_size=1)), min_size=1))
def test_what_was_written_reads_back_equal(
    tmp_path_factory: pytest.TempPathFactory, entries: list[tuple[Run, list[Figure]]]
) -> None:
    path = tmp_path_factory.mktemp("history") / "history.csv"
    for run, found in entries:
        append(path, run, found)
    assert read(path) == [Entry(run, figure) for run, found in entries for figure in found]


@given(st.binary() | st.text().map(lambda text: (",".join(COLUMNS) + "\n" + text).encode("utf-8", "replace")))
def test_a_file_of_any_bytes_is_read_or_named(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.mktemp("history") / "history.csv"
    path.write_bytes(content)
    told = ""
    try:
        found = read(path)
    except ValueError as error:
        told = str(error)
    else:
        assert all(isinstance(entry, Entry) for entry in found)
    assert told == "" or told.startswith(f"{path}:")


def test_a_slide_is_red_and_said_in_words() -> None:
    console = Console(force_terminal=True, color_system="standard", width=120, record=True)
    slide = Change(exact("flash", 101, "bytes"), Entry(HERE, exact("flash", 100, "bytes")))
    with console.capture() as capture:
        console.print(table([slide, Change(exact("sram", 1, "bytes"), None)]))
    (line,) = [line for line in capture.get().splitlines() if "flash" in line]
    assert "\x1b[31m" in line
    assert "+1.0% WORSE" in line
    assert "\x1b[31m" not in next(line for line in capture.get().splitlines() if "sram" in line)


def test_the_end_of_a_run_compares_keeps_and_forgets(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    kept, place = tmp_path / "history.csv", tmp_path / "figures.jsonl"
    monkeypatch.setattr(history, "NOTED", place)
    monkeypatch.setattr(history, "noted", lambda: figures.noted(place))
    monkeypatch.setattr("sys.argv", ["history", "--history", str(kept)])
    assert history.main() == 2
    for value, said in ((100, "new"), (101, "WORSE")):
        note(exact("flash", value, "bytes"), place=place)
        assert history.main() == 0
        assert said in capsys.readouterr().out
        assert not place.exists()
    assert [entry.figure.value for entry in read(kept)] == [100, 101]


def test_the_machine_is_named_by_its_processor(tmp_path: Path) -> None:
    info = tmp_path / "cpuinfo"
    info.write_text("processor: 0\nmodel name : Quick CPU\nmodel name : Quick CPU\n")
    assert machine(info).startswith("Quick CPU, ")
    assert machine(tmp_path / "none").endswith(" cores")
