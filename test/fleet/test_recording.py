"""Recordings: what is written is read back, and what is none is refused with its line."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.refusal import read_or_refused
from support.strategies import damaged
from tilenca.base.errors import UsageError
from tilenca.fleet.grid import Laid
from tilenca.fleet.recording import (
    Choice,
    Recorder,
    format_event,
    parse_event,
    read_recording,
    recorded_shapes,
)
from tilenca.fleet.state import Event, PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import parse_sentence

times = st.integers(0, 2**52).map(lambda us: us / 2**20).map(lambda s: round(s, 6))
events: st.SearchStrategy[Event] = st.one_of(
    st.builds(lambda t, p, raw: Heard(t, p, raw, parse_sentence(raw)), times, st.text(), st.binary()),
    st.builds(PortNews, times, st.text(), st.booleans(), st.text()),
)


@given(events)
def test_an_event_is_read_back_as_it_was(event: Event) -> None:
    line = format_event(event)
    assert line.count("\n") == 1
    assert line.isascii()
    assert parse_event(line) == event


def test_places_are_written_as_far_as_they_are_news_and_read_in_their_order(tmp_path: Path) -> None:
    path = tmp_path / "record"
    said = format_event(Heard(2.0, "a", b"$ASK*59", None))
    with Recorder(path, "w") as record:
        for laid in ({"a": Laid((0, 1), 7), "b": Laid((0, 2), 9)}, {"a": Laid((0, 1), 7)}):
            record.place(2.0, laid, shape="4")
            record.place(2.5, laid, shape="4")
            record.write([said])
    assert recorded_shapes(path) == ["4"]
    told: list[object] = []
    for event in read_recording(path, lambda port, laid: told.append((port, laid))):
        told.append(event.port)
    assert told == [("a", Laid((0, 1), 7)), ("b", Laid((0, 2), 9)), "a", ("b", None), "a"]
    told.clear()
    list(Choice(path, ["b"], lambda port, laid: told.append(port)))
    assert told == ["b", "b"]


@given(st.text())
def test_any_other_line_is_a_value_error_or_an_event(line: str) -> None:
    try:
        parse_event(line)
    except ValueError:
        return


@pytest.mark.parametrize(
    "line",
    [
        "{}",
        "[]",
        "1",
        "not json",
        '{"time": 1, "port": "p"}',
        '{"time": "1", "port": "p", "raw": ""}',
        '{"time": 1, "port": "p", "place": [0, 1.0]}',
        '{"time": 1, "port": "p", "place": [0, 1], "tile": 0}',
    ],
)
def test_a_bad_line_is_named(line: str, tmp_path: Path) -> None:
    path = tmp_path / "record"
    path.write_text(format_event(PortNews(1.0, "p", is_open=True)) + line + "\n")
    with pytest.raises(
        UsageError, match=rf"^{path}:2: not a recorded event .*; give a file that --record wrote$"
    ):
        list(read_recording(path))


@pytest.mark.parametrize("content", [b"\xff\n", None])
def test_what_is_no_text_file_is_refused(content: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "record"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(UsageError, match=rf"^{path}: "):
        list(read_recording(path))


@pytest.mark.parametrize("moment", ["NaN", "Infinity", "-1", "1e18"])
def test_a_moment_that_no_clock_shows_is_refused(moment: str) -> None:
    with pytest.raises(ValueError, match="is no time"):
        parse_event(f'{{"time": {moment}, "port": "p", "raw": ""}}')


def test_a_recording_that_was_cut_off_is_played_to_there_and_not_appended_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "record"
    whole = format_event(PortNews(1.0, "p", is_open=True))
    path.write_text(whole + whole[:-9])
    assert list(read_recording(path)) == [PortNews(1.0, "p", is_open=True)]
    assert capsys.readouterr().err.startswith(f"{path}:2: cut off")
    with pytest.raises(UsageError, match="its last line is cut off"):
        Recorder(path, "a")
    path.write_text(whole)
    with Recorder(path, "a") as record:
        record.write([whole])
    assert path.read_text() == 2 * whole


def test_the_shapes_of_emulated_runs_are_known(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    lines = ['{"time": 1.0, "shape": "4"}', "cut", '{"time": 2.0, "shape": "1"}', '{"shape": "4"}', "[]"]
    path.write_text("\n".join(lines), encoding="ascii")
    assert recorded_shapes(path) == ["4", "1"]
    assert recorded_shapes(tmp_path / "none") == []


GOOD = format_event(PortNews(1.0, "p", is_open=True)) + format_event(Heard(2.5, "p", b"$ASK*59\r\n", None))


@given(damaged(GOOD.encode()))
def test_a_file_of_any_bytes_is_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "record.jsonl"
    found = read_or_refused(path, content, lambda path: list(read_recording(path)))
    assert all(parse_event(format_event(event)) == event for event in found or [])
    assert all(isinstance(name, str) for name in recorded_shapes(path))
