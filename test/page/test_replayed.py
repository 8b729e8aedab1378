"""Recordings of `--record` become recordings of the page."""

import json
from pathlib import Path

import pytest

from support.heard_fleet import STATE, link
from tilenca import cli
from tilenca.base.errors import UsageError
from tilenca.fleet.recording import format_event
from tilenca.fleet.state import Event, PortNews
from tilenca.page.replayed import page_recording
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import Sentence, TileSentence, format_sentence
from tilenca.protocol.stream import StreamEvent

LABELS = tuple("0123456789")
BEGAN_S = 1_700_000_000.0


def told(path: Path) -> list[StreamEvent]:
    return [json.loads(line) for line in page_recording(path, LABELS, lambda model: None).splitlines()]


def heard(time_s: float, port: str, sentence: Sentence) -> Event:
    return Heard(time_s, port, format_sentence(sentence).strip(), sentence)


def test_one_of_the_monitor_has_places_and_displays_and_counts_from_its_beginning(tmp_path: Path) -> None:
    record = tmp_path / "record.jsonl"
    events: list[Event] = [PortNews(BEGAN_S, "/dev/a", True), PortNews(BEGAN_S, "/dev/b", True)]
    for second in range(1, 5):
        now_s = BEGAN_S + second
        for tile, port, side, other in ((1, "/dev/a", "E", 2), (2, "/dev/b", "W", 1)):
            links = "-E--" if side == "E" else "---W"
            label = 7 if second < 3 else 1
            events.append(
                heard(now_s, port, TileSentence(tile, 9, second, str(label), label, 30, links, STATE))
            )
            events.append(heard(now_s, port, link(tile, side, other)))
    record.write_text("".join(map(format_event, events)))
    first, run, *rest = told(record)
    assert (first["source"], run["run"]["began"]) == ("watched", BEGAN_S)
    places = {event["port"]: event["place"] for event in rest if event.get("place")}
    assert places == {"/dev/a": [0, 0], "/dev/b": [0, 1]}
    shown = [
        event["display"]["segments"] for event in rest if event.get("port") == "/dev/a" and "display" in event
    ]
    assert shown == [0b0000111, 0b0000110], "a 7, a 1"
    assert any(event.get("note") == "shows 1, before 7" for event in rest)
    assert rest[-1]["pace"]["end"] == 4.0
    assert max(event["time"] for event in rest) == 4.0


def test_one_of_emulated_tiles_does_too(tmp_path: Path, firmware: Path) -> None:
    record = tmp_path / "record.jsonl"
    words = "emulate --shape 1 --seconds 1.5 --bootloader none --boot-spread 0"
    assert cli.main([*words.split(), "--elf", str(firmware), "--record", str(record)]) == 0
    events = told(record)
    assert len({event["port"] for event in events if event.get("place")}) == 5
    assert {tuple(event["place"]) for event in events if event.get("place")} >= {(0, 0), (4, 0)}
    assert events[-1]["pace"]["end"] == pytest.approx(1.5, abs=0.2)


def test_one_of_the_page_stays_as_it_is(tmp_path: Path) -> None:
    text = '{"time": 0, "stream": 1, "source": "emulated"}\n{"time": 0, "run": {"seed": 1}}\n'
    record = tmp_path / "record.jsonl"
    record.write_text(text)
    assert page_recording(record, LABELS, lambda model: None) == text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "nothing is recorded"),
        ('{"time": 0, "stream": true}\n', "version True of the stream"),
        ("hello\n", "not a recorded event"),
        ('{"time": 0, "stream": 9}\n', "version 9 of the stream"),
        ("\u00e9\n", "not a recording"),
    ],
)
def test_what_is_none_is_refused(tmp_path: Path, text: str, words: str) -> None:
    record = tmp_path / "record.jsonl"
    record.write_text(text, encoding="latin-1")
    with pytest.raises(UsageError, match=words):
        page_recording(record, LABELS, lambda model: None)
    with pytest.raises(UsageError, match="No such file"):
        page_recording(tmp_path / "none", LABELS, lambda model: None)


BEGINNING = '{"time": 0, "stream": 1, "source": "emulated"}\n{"time": 0, "run": {"seed": 1}}\n'
PACE = '{"time": 1, "pace": {"speed": 1, "paused": false, "share": 1}}\n'


def test_one_of_the_page_that_is_cut_loses_its_last_line_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = tmp_path / "record.jsonl"
    record.write_text(BEGINNING + PACE + PACE[:20])
    assert page_recording(record, LABELS, lambda model: None) == BEGINNING + PACE
    assert f"{record}:4: cut off in its middle" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("nonsense", "3: is no event"),
        ("[]", "3: is no event"),
        ('{"time": 1e8, "pace": {}}', "3: is no event"),
        ('{"time": NaN, "pace": {}}', "3: is no event"),
        ('{"time": 1, "pace": {}}', "3: tells of a pace that cannot be"),
        ('{"time": 1, "place": [0, 1]}', "3: tells of a place, and not of which tile"),
        ('{"time": 1, "port": "a", "place": [0, 1], "open": true}', "3: tells of place and open at once"),
        ('{"time": 1, "run": {"seed": 1}}', "3: it has more than one run"),
        ('{"time": 1, "port": "a", "place": [0, 1001]}', "3: tells of a place that cannot be"),
        (f'{{"time": 1, "port": "a", "raw": "{"x" * 4097}"}}', "3: tells of a raw that cannot be"),
    ],
)
def test_what_the_page_would_not_show_is_refused(tmp_path: Path, line: str, why: str) -> None:
    record = tmp_path / "record.jsonl"
    record.write_text(f"{BEGINNING}{line}\n{PACE}")
    with pytest.raises(UsageError, match=why):
        page_recording(record, LABELS, lambda model: None)


def test_one_that_has_no_run_or_too_many_events_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = tmp_path / "record.jsonl"
    record.write_text(BEGINNING.splitlines(keepends=True)[0])
    with pytest.raises(UsageError, match="does not begin"):
        page_recording(record, LABELS, lambda model: None)
    monkeypatch.setattr("tilenca.page.recording_file.MOST_EVENTS", 3)
    record.write_text(BEGINNING + 2 * PACE)
    with pytest.raises(UsageError, match="more than 3 events"):
        page_recording(record, LABELS, lambda model: None)
