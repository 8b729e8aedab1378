"""The events of the stream: one subject each, and telemetry as recordings have had it all along."""

import json

import pytest

from tilenca.fleet.recording import parse_event
from tilenca.protocol import stream
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import parse_sentence

EVENTS = {
    "stream": stream.stream_event("emulated", looks=[]),
    "run": stream.run_event(0.0, {"seed": 3}),
    "jump": stream.jump_event(1.0, 2.5),
    "pace": stream.pace_event(1.0, 0.1, False, 0.98765, 2.5),
    "place": stream.place_event(1.0, "tile-03", (2, -1)),
    "cable": stream.cable_event(1.0, "tile-03", "E", whole=False),
    "fault": stream.fault_event(1.0, "tile-03", turned=True, skew=-20000.12345),
    "chip": stream.chip_event(1.0, "tile-03", {"pc": 0x743C, "function": "loop"}),
    "raw": stream.raw_event(1.23456789, "tile-03", b"$ASK*\xff"),
    "open": stream.open_event(1.0, "tile-03", False, "no power"),
    "deed": stream.deed_event(1.0, {"do": "pull", "port": "tile-03"}),
    "display": stream.display_event(1.0, "tile-03", 0x66, (5, 50, 30), "N-S-"),
    "frame": stream.frame_event(1.0, "tile-03", "E", b"\x01\x02"),
    "classes": stream.classes_event(1.0, [{"label": "4", "segments": 102, "rgb": [5, 50, 30]}]),
    "health": stream.health_event(1.0, "tile-03", "silent", {"N": ("well", 0.987), "S": ("none", None)}),
    "note": stream.note_event(1.0, "tile-03", "shows 4", bad=False),
    "refused": stream.refused_event(0.0, "no tile lies there"),
}


def test_there_is_an_event_of_each_kind() -> None:
    assert tuple(EVENTS) == stream.KINDS


@pytest.mark.parametrize("kind", stream.KINDS)
def test_an_event_has_a_time_and_one_subject_and_is_json(kind: str) -> None:
    event = json.loads(json.dumps(EVENTS[kind]))
    assert isinstance(event["time"], float)
    assert [other for other in stream.KINDS if other in event] == [kind]


def test_a_tile_that_was_taken_away_has_no_place() -> None:
    assert stream.place_event(1.0, "tile-03", None)["place"] is None


def test_what_a_tile_said_is_read_back_to_the_byte() -> None:
    raw = bytes(range(256))
    event = parse_event(json.dumps(stream.raw_event(1.5, "tile-01", raw)))
    assert event == Heard(1.5, "tile-01", raw, parse_sentence(raw))


@pytest.mark.parametrize("kind", [kind for kind in stream.KINDS if kind not in ("raw", "open", "place")])
def test_the_monitor_passes_over_what_is_no_telemetry(kind: str) -> None:
    assert parse_event(json.dumps(EVENTS[kind])) is None


def test_an_event_with_two_subjects_is_none() -> None:
    with pytest.raises(ValueError, match="neither a line"):
        parse_event('{"time": 1.0, "port": "tile-01", "place": [1, 2], "frame": "00"}')
