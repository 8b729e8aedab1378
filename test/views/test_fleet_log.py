"""What the monitor prints where there is no picture."""

import json

import pytest

from support.tile_port import STATE
from tilenca.fleet.grid import Grid
from tilenca.fleet.state import Event, Fleet, PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import TileSentence
from tilenca.views.fleet_log import EventLines, JsonLines, Lines, NewsLines

PORT = "/dev/ttyACM0"


def said(second: float, label: int) -> Heard:
    return Heard(second, PORT, b"", TileSentence(7, 100, 1, str(label), label, 30, "----", STATE))


EVENTS: list[Event] = [
    PortNews(100.0, PORT, is_open=True),
    said(101.0, 4),
    Heard(102.0, PORT, b"$x", None),
    said(103.0, 4),
    said(104.0, 1),
]


def shown(lines: Lines, fleet: Fleet) -> None:
    for event in EVENTS:
        fleet.take(event)
        lines.show(event.time_s, [event])


def test_json_is_of_good_sentences_and_the_rest_is_chatter(capsys: pytest.CaptureFixture[str]) -> None:
    shown(JsonLines(0.0), Fleet())
    printed = capsys.readouterr()
    assert [json.loads(line)["fields"]["label"] for line in printed.out.splitlines()] == ["4", "4", "1"]
    assert [line.split(" ", 2)[2] for line in printed.err.splitlines()] == ["- PORT open", "- DAMAGED $x"]


def test_every_event_is_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    shown(EventLines(0.0), Fleet())
    printed = capsys.readouterr()
    assert len(printed.out.splitlines()) == len(EVENTS)
    assert printed.err == ""


def test_news_is_what_changed(capsys: pytest.CaptureFixture[str]) -> None:
    fleet = Fleet()
    shown(NewsLines(0.0, fleet, Grid()), fleet)
    told = [line.split(PORT + " ")[1] for line in capsys.readouterr().out.splitlines()]
    assert told == ["port open", "shows 4", "damaged: $x", "shows 1, before 4"]


def test_what_was_before_the_start_is_known_and_not_printed(capsys: pytest.CaptureFixture[str]) -> None:
    fleet = Fleet()
    shown(NewsLines(3.0, fleet, Grid()), fleet)
    told = [line.split(PORT + " ")[1] for line in capsys.readouterr().out.splitlines()]
    assert told == ["shows 1, before 4"], "the 4 of before is not told again"
