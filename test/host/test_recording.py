"""Recordings: what is written is played back, at its pace, and what is none is refused with its line."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.errors import UsageError
from tilenca.protocol import parse_sentence
from tilenca.recording import format_event, paced, parse_event, read_recording
from tilenca.telemetry import Event, Heard, PortNews

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


@given(st.text())
def test_any_other_line_is_a_value_error_or_an_event(line: str) -> None:
    try:
        parse_event(line)
    except ValueError:
        return


@pytest.mark.parametrize(
    "line", ["{}", "[]", "1", "not json", '{"time": 1, "port": "p"}', '{"time": "1", "port": "p", "raw": ""}']
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


class Clock:
    """Time that passes only by sleeping."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        assert seconds > 0
        self.now_s += seconds


@pytest.mark.parametrize("speed", [0.5, 1.0, 10.0])
def test_events_are_played_at_their_pace(speed: float) -> None:
    clock = Clock()
    recorded = [PortNews(1000.0 + offset, "p", is_open=True) for offset in (0.0, 0.5, 0.5, 3.0)]
    played = []
    last_tick_s = clock()
    for _, due in paced(recorded, speed, 0.2, 0.0, clock, clock.sleep):
        assert clock() - last_tick_s <= 0.2 + 1e-9, "the display is fed at least every tick"
        last_tick_s = clock()
        played += [(clock() - 100.0, event) for event in due]
    assert [event for _, event in played] == recorded
    assert [at_s for at_s, _ in played] == pytest.approx(
        [0.0, 0.5 / speed, 0.5 / speed, 3.0 / speed], abs=1e-3
    )


def test_a_replay_from_later_on_plays_what_was_before_at_once() -> None:
    clock = Clock()
    recorded = [PortNews(1000.0 + offset, "p", is_open=True) for offset in (0.0, 50.0, 61.0)]
    times = [
        (round(clock() - 100.0, 2), event.time_s)
        for _, due in paced(recorded, 2.0, 0.2, 60.0, clock, clock.sleep)
        for event in due
    ]
    assert times == [(0.0, 1000.0), (0.0, 1050.0), (0.5, 1061.0)]


def test_speed_0_never_waits() -> None:
    clock = Clock()
    recorded = [PortNews(time_s, "p", is_open=True) for time_s in (0.0, 1e6)]
    assert len(list(paced(recorded, 0.0, 0.2, 0.0, clock, clock.sleep))) == 2
    assert clock() == 100.0
