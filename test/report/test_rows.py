"""Rows are read from what the commands print, and each has the command that repeats it."""

import json
import shlex
from pathlib import Path
from typing import Any

import pytest

from tilenca import cli
from tilenca.base import paths
from tilenca.model.file import load_model
from tilenca.report.rows import (
    BYTES,
    SECONDS,
    SHARE,
    STEPS,
    read_agreement,
    read_curve,
    read_emulations,
    read_evaluation,
    read_plugging,
    read_states,
    read_suite,
    read_sweep,
    read_sweep_times,
    seed_of,
    slug,
)


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert cli.main([*words, "--json"]) == 0
    result: dict[str, Any] = json.loads(capsys.readouterr().out)
    return result


def test_an_evaluation_has_a_share_with_an_interval_and_a_time(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("evaluate", "--steps", "60", "--runs", "3", "--seed", "7")
    right, time = read_evaluation("paper.x", "ten digits", printed(capsys, *words), words)
    assert (right.key, right.unit, right.runs, right.seed) == ("paper.x.right", SHARE, 30, 7)
    assert right.low is not None
    assert right.value is not None
    assert right.low < right.value
    assert (time.unit, time.low) == (STEPS, None)
    assert shlex.split(right.command) == ["tilenca", *words]


def test_a_row_of_the_suite_repeats_by_its_own_command(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("evaluate", "--suite", "--runs", "2", "--seed", "7")
    rows = read_suite("suite", "", printed(capsys, *words, "--row", "listing", "--row", "12x10, any"), words)
    assert len(rows) == 7
    assert len({row.key for row in rows}) == 7
    last = rows[-1]
    _, *again = shlex.split(last.command)
    (same,) = read_suite("suite", "", printed(capsys, *again), words)
    assert same == last


def test_a_curve_has_a_row_for_every_update(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("simulate", "--shape", "4", "--steps", "6", "--runs", "2", "--seed", "3")
    rows = read_curve("paper.curve.4", "'4', the paper's listing", printed(capsys, *words), words)
    assert [row.across for row in rows] == [1, 2, 3, 4, 5, 6]
    assert {row.line for row in rows} == {"'4'"}
    assert all(row.value is not None and 0 <= row.value <= 1 for row in rows)


def test_an_agreement_has_a_curve_beside_and_some_of_it_in_the_table(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ("evaluate", "--steps", "60", "--runs", "2", "--seed", "7")
    rows = read_agreement("gap.x.60", "ten digits, fast", printed(capsys, *words), words)
    assert [row.across for row in rows] == [None, None, *range(1, 31)]
    assert [row.across for row in rows if not row.only_drawn] == [None, None, 8, 10, 12]
    values = [row.value for row in rows[2:]]
    assert values == sorted(values, key=lambda value: value or 0)
    assert values[-1] == rows[0].value
    assert {row.line for row in rows[2:]} == {"fast"}


def told(size: str, latency: str, share: float, median: float | None) -> dict[str, Any]:
    return {
        "shape": "all", "size": size, "latency": latency, "share": share, "low": 0.1, "high": 0.9, "runs": 10,
        "seed": 3, "command": "tilenca sweep", "median": median,
    }  # fmt: skip


def test_values_of_a_sweep_lie_where_their_numbers_say() -> None:
    words = ("sweep", "--axis", "size=5x4,drawn", "--axis", "latency=0.5,0.1-0.9", "--seed", "3")
    result = {"rows": [told("5x4", "0.5", 1.0, 7.0), told("drawn", "0.1-0.9", 0.5, None), {"shape": "4"}]}
    first, second = read_sweep("edges.x", "larger", result, words)
    assert (first.across, second.across) == (20.0, None)
    assert first.place == {"size": "5x4", "latency": "0.5"}
    assert second.line == "latency 0.1-0.9"
    times = read_sweep_times("edges.x", "larger", result, words)
    assert [(row.value, row.unit, row.low) for row in times] == [(7.0, STEPS, None), (None, STEPS, None)]


def test_seeds_and_keys_are_read_from_words() -> None:
    assert seed_of(["emulate", "--seed", "12", "--json"]) == 12
    assert slug("20 % of the messages lost, read as zero") == "20-of-the-messages-lost-read-as-zero"


@pytest.mark.usefixtures("firmware")
@pytest.mark.parametrize("shapes", [("7",), ("7", "1")])
def test_an_emulation_has_a_share_and_two_times(
    shapes: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("emulate", *(word for shape in shapes for word in ("--shape", shape)), "--seed", "4")
    right, powered, updated = read_emulations("paper.tiles", "digits", printed(capsys, *words), words)
    assert (right.value, right.runs, right.unit) == (1.0, len(shapes), SHARE)
    assert powered.unit == updated.unit == SECONDS
    assert powered.value is not None
    assert updated.value is not None
    assert powered.value > updated.value


@pytest.mark.usefixtures("firmware")
def test_a_change_has_a_share_and_times_from_the_change(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    drawing = tmp_path / "one.toml"
    drawing.write_text('[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n#\n"""\n')
    plugged = ("--engine", "emulator", "--plug", "again")
    words = ("evaluate", "--shapes", str(drawing), *plugged, "--runs", "2", "--seed", "4")
    right, median, most, updates = read_plugging("plug.x", "a tile", printed(capsys, *words), words)
    assert (right.value, right.runs) == (1.0, 2)
    assert median.unit == most.unit == SECONDS
    assert median.value is not None
    assert most.value is not None
    assert 0.1 < median.value <= most.value < 1.0
    assert median.low is not None
    assert median.low <= median.value
    assert updates.unit == STEPS


@pytest.mark.usefixtures("firmware")
def test_states_are_counted_and_none_differs(capsys: pytest.CaptureFixture[str]) -> None:
    words = (
        "emulate",
        "--check-states",
        "--bootloader",
        "none",
        "--shape",
        "1",
        "--updates",
        "30",
        "--seed",
        "4",
    )
    differ, states, count, messages, again = read_states(
        "gap.states", "the 1", printed(capsys, *words), words
    )
    assert differ.value == 0
    assert states.value is not None
    assert states.value >= 5 * 30
    bytes_each = 2 * load_model(paths.DEFAULT_MODEL).dimensions.channels
    assert (count.value, count.unit) == (bytes_each * states.value, BYTES)
    assert messages.value is not None
    assert again.value is not None
    assert messages.value > again.value
