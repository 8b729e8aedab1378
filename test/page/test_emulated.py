"""The native emulator behind the page: what a hand does is told, and the same start is the same run."""

import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tilenca import cli
from tilenca.base.errors import UsageError
from tilenca.base.paths import DEFAULT_SHAPES
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.emulated import EmulatedSource
from tilenca.page.offer import Drawing
from tilenca.protocol import stream_commands as commands
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.sentences import TileSentence, parse_sentence
from tilenca.protocol.stream import KINDS, StreamEvent
from tilenca.shapes.file import load_task

TICK_S = 1 / 60
TASK = load_task(DEFAULT_SHAPES)
FOUR = TASK.find("4").cells


@pytest.fixture
def source(firmware: Path) -> Iterator[EmulatedSource]:
    drawings = [Drawing(f"digits/{shape.name}", shape) for shape in TASK.shapes]
    made = EmulatedSource(firmware, firmware_settings(firmware), TASK.labels, drawings)
    yield made
    made.close()


def play(source: EmulatedSource, wall_s: float) -> list[StreamEvent]:
    """So much time at the page."""
    return [event for _ in range(round(wall_s / TICK_S)) for event in source.advance(TICK_S)]


def of(events: list[StreamEvent], kind: str) -> list[StreamEvent]:
    return [event for event in events if kind in event]


def labels(events: list[StreamEvent]) -> dict[str, str]:
    """The last label that each tile has told."""
    told = {}
    for event in of(events, "raw"):
        if isinstance(sentence := parse_sentence(event["raw"].encode("latin-1")), TileSentence):
            told[event["port"]] = sentence.label
    return told


def test_it_tells_first_what_it_is(source: EmulatedSource) -> None:
    [first] = source.begin()
    assert (first["stream"], first["source"]) == (1, "emulated")
    assert [look["label"] for look in first["looks"]] == [*"0123456789", "-"]
    assert first["drawings"][4] == {"name": "digits/4", "label": "4", "rows": list(TASK.find("4").rows)}
    assert first["period_ms"] == 20
    assert source.is_idle
    assert source.advance(1.0) == []


def test_ten_tiles_boot_and_agree(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, speed=1.0, spread_s=0.25))
    events = play(source, 1.5)
    assert of(events, "run")[0]["run"] == {"seed": 0, "shape": "4", "tiles": 10}
    assert [event["place"] for event in of(events, "place")] == [list(cell) for cell in FOUR]
    assert set(labels(events).values()) == {"4"}
    shown = {event["port"]: event["display"] for event in of(events, "display")}
    assert {(display["segments"], tuple(display["rgb"])) for display in shown.values()} == {
        (0x66, (5, 50, 30))
    }
    assert of(events, "frame") == []  # too fast to see them
    assert all(sum(kind in event for kind in KINDS) == 1 for event in events)
    assert all(json.loads(json.dumps(event)) == event for event in events)


def test_the_same_start_says_the_same_bytes_as_the_command(
    source: EmulatedSource, tmp_path: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = tmp_path / "said.jsonl"
    faults = ["loss=0.05", "cut@3-5", "off@7"]
    words = [word for fault in faults for word in ("--fault", fault)]
    start = ["--shape", "4", "--seed", "11", "--boot-spread", "0.3", "--elf", str(firmware)]
    cli.main(["emulate", *start, "--seconds", "0.9", "--bootloader", "none", "--record", str(record), *words])
    capsys.readouterr()
    source.take(
        commands.Open(
            FOUR, seed=11, faults=tuple(faults), spread_s=0.3, speed=0.73, until_s=0.9, paused=False
        )
    )
    events = play(source, 2.0)
    assert of(events, "pace")[-1]["pace"]["paused"]
    recorded = [json.loads(line) for line in record.read_text().splitlines() if '"raw"' in line]
    assert [(one["time"], one["port"], one["raw"]) for one in recorded] == [
        (event["time"], event["port"], event["raw"]) for event in sorted(
            of(events, "raw"), key=lambda event: (event["time"], event["port"])
        )
    ]  # fmt: skip
    assert len(recorded) > 100
    assert [event["cable"] for event in of(events, "cable")] == ["cut"]
    assert "tile-07" not in labels(events)


def test_a_pulled_tile_goes_and_the_others_go_on(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.0))
    play(source, 1.0)
    source.take(hands.Pull("tile-02"))
    events = play(source, 0.5)
    assert of(events, "place") == [{"time": of(events, "place")[0]["time"], "port": "tile-02", "place": None}]
    assert "tile-02" not in labels(events)
    assert len(labels(events)) == 9
    source.take(hands.Put(0, 3))
    events = play(source, 1.0)
    assert of(events, "place")[0]["place"] == [0, 3]
    assert labels(events)["tile-02"] == "4"


def test_power_and_cables_are_told_once(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.0))
    play(source, 0.3)
    source.take(hands.Power("tile-05", on=False))
    source.take(hands.Cut("tile-03", "N"))
    events = play(source, 0.3)
    assert [(one["port"], one["open"], one["reason"]) for one in of(events, "open")] == [
        ("tile-05", False, "no power")
    ]
    assert [(one["port"], one["side"], one["cable"]) for one in of(events, "cable")] == [
        ("tile-01", "S", "cut")
    ]
    source.take(hands.Power("tile-05", on=True))
    source.take(hands.Cut("tile-01", "S", on=False))
    events = play(source, 0.3)
    assert [(one["port"], one["open"]) for one in of(events, "open")] == [("tile-05", True)]
    assert [one["cable"] for one in of(events, "cable")] == ["whole"]


def test_in_slow_motion_frames_are_told_and_a_step_is_one_period(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.0, speed=0.1))
    events = play(source, 2.0)
    frames = of(events, "frame")
    assert {event["side"] for event in frames} == set("NESW")
    assert len({event["port"] for event in frames}) == 10
    source.take(commands.Pace(0.1, paused=True))
    before_s = of(source.advance(TICK_S), "pace")[-1]["time"]
    assert play(source, 0.2) == []
    source.take(commands.Step(0.02))
    after_s = of(source.advance(TICK_S), "pace")[-1]["time"]
    assert after_s - before_s == pytest.approx(0.02, abs=32e-6)
    assert source.is_idle


def test_while_nobody_looks_time_stands_still(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.0))
    source.take(commands.Rest(True))
    assert of(play(source, 0.5), "raw") == []
    assert source.is_idle
    source.take(commands.Rest(False))
    assert of(play(source, 0.5), "raw") != []


def test_what_cannot_be_is_one_line(source: EmulatedSource) -> None:
    with pytest.raises(UsageError, match="nothing runs yet"):
        source.take(hands.Pull("tile-01"))
    with pytest.raises(UsageError, match="begins with none of"):
        source.take(commands.Open(FOUR, faults=("explode",)))
    with pytest.raises(UsageError, match="no tile '99'"):
        source.take(commands.Open(FOUR, faults=("off@99",)))
    source.take(commands.Open(FOUR))
    with pytest.raises(UsageError, match="no tile tile-99 lies on the board"):
        source.take(hands.Pull("tile-99"))
    with pytest.raises(UsageError, match="has no neighbour"):
        source.take(hands.Cut("tile-01", "W"))


def test_the_board_has_room_for_so_many(source: EmulatedSource) -> None:
    cells = tuple((row, col) for row in range(12) for col in range(12))
    source.take(commands.Open(cells, paused=True))
    with pytest.raises(UsageError, match="144 tiles, which is all"):
        source.take(hands.Put(12, 0))


places = st.tuples(st.integers(-1, 3), st.integers(-1, 3))
ports = st.integers(1, 6).map(lambda number: f"tile-{number:02d}")
deeds = st.one_of(
    st.builds(hands.Put, st.integers(-1, 3), st.integers(-1, 3)),
    st.builds(hands.Pull, ports),
    st.builds(hands.Move, ports, st.integers(-1, 3), st.integers(-1, 3)),
    st.builds(hands.Cut, ports, st.sampled_from("NESW"), st.booleans()),
    st.builds(hands.Power, ports, st.booleans()),
    st.builds(hands.Freeze, ports, st.booleans()),
    st.builds(hands.Turn, ports, st.booleans()),
    st.builds(hands.Skew, ports, st.sampled_from((-80_000.0, 0.0, 5_000.0))),
    st.builds(hands.Shift, st.lists(ports, max_size=4).map(tuple), st.integers(-2, 2), st.integers(-2, 2)),
    st.builds(commands.Pace, st.just(1.0), st.booleans()),
    st.builds(commands.Instruct, ports, st.sampled_from((0, 1, 100))),
    st.builds(hands.Reset, ports),
    st.builds(hands.Noise, st.floats(0, 1)),
    st.builds(hands.Arrange, st.lists(places, min_size=1, max_size=5, unique=True).map(tuple)),
)


@given(st.lists(deeds, max_size=12))
@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_hands_do_the_page_knows_what_lies_where(
    source: EmulatedSource, wanted: list[commands.StreamCommand]
) -> None:
    source.take(commands.Open(((0, 0), (0, 1), (1, 0)), spread_s=0.0))
    events = source.advance(TICK_S)
    for command in wanted:
        with suppress(UsageError):  # a tile lies there, or none does
            source.take(command)
        events += source.advance(TICK_S)
    known: dict[str, list[int]] = {}
    for event in of(events, "place"):
        known.pop(event["port"], None)
        if event["place"] is not None:
            known[event["port"]] = event["place"]
    board = source._board
    assert known == {f"tile-{tile + 1:02d}": list(place) for tile, place in board.places.items()}
    assert len({tuple(place) for place in known.values()}) == len(known)
    joined = {(link[0], link[2]) for link in source._emulation.cables} if source._emulation else set()
    beside = {
        (a, b)
        for a, (row, col) in board.places.items()
        for b, other in board.places.items()
        if other in ((row + 1, col), (row, col + 1))
    }
    assert joined == beside


def said(source: EmulatedSource, steps: int) -> list[StreamEvent]:
    """What tiles say, and where they lie, in so many twentieths of a second."""
    events = []
    for _ in range(steps):
        source.take(commands.Step(0.05))
        events += [event for event in source.advance(0.0) if "raw" in event or "place" in event]
    return events


def test_time_goes_back_and_the_same_future_comes(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.1, paused=True, faults=("loss=0.1", "cut@1-3:0.2-0.5")))
    first = said(source, 5)
    source.take(hands.Pull("tile-04"))
    source.take(hands.Put(9, 9))
    then = source.advance(0.0) + said(source, 8)
    source.take(commands.Seek(0.1))
    jump, *state = source.advance(0.0)
    assert (jump["time"], jump["jump"]) == (pytest.approx(0.1, abs=2e-5), {"from": pytest.approx(0.65)})
    assert [event["place"] for event in of(state, "place")] == [list(cell) for cell in FOUR]
    assert of(state, "pace")[-1]["pace"] | {"end": 0} == {
        "speed": 1.0, "paused": True, "share": 1.0, "end": 0,
    }  # fmt: skip
    again = said(source, 11)
    raws = [event for event in first + then if "raw" in event and event["time"] > jump["time"]]
    assert of(again, "raw") == raws
    assert [(event["port"], event["place"]) for event in of(again, "place")] == [("tile-04", [9, 9])]


def test_another_deed_in_the_past_begins_another_future(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.1, paused=True))
    said(source, 6)
    source.take(hands.Pull("tile-04"))
    said(source, 2)
    source.take(commands.Seek(0.2))
    source.take(hands.Pull("tile-10"))
    assert of(source.advance(0.0), "pace")[-1]["pace"]["end"] == pytest.approx(0.2, abs=2e-5)
    assert {event["port"] for event in said(source, 6) if "place" in event} == set()
    source.take(commands.Seek(99.0))
    events = source.advance(0.0)
    assert events[0]["time"] == pytest.approx(0.5, abs=1e-4)
    assert "tile-04" in {event["port"] for event in of(events, "place")}
    assert "tile-10" not in {event["port"] for event in of(events, "place")}


def test_a_deed_is_taken_back_and_the_tiles_run_on_without_it(source: EmulatedSource) -> None:
    source.take(commands.Open(FOUR, spread_s=0.1, paused=True))
    said(source, 6)
    source.take(hands.Pull("tile-04"))
    said(source, 2)
    source.take(commands.Seek(0.2999, forget=True))
    jump, *state = source.advance(0.0)
    assert jump["jump"]["forget"] is True
    assert of(state, "pace")[-1]["pace"]["end"] == pytest.approx(0.2999, abs=2e-5)
    events = said(source, 6)
    assert of(events, "place") == []
    assert labels(events).keys() >= {"tile-04"}


def test_there_is_no_past_before_a_run(source: EmulatedSource) -> None:
    with pytest.raises(UsageError, match="nothing runs yet"):
        source.take(commands.Seek(0.0))


def test_a_run_with_deeds_is_the_run_that_hands_made(source: EmulatedSource) -> None:
    start = commands.Open(FOUR, spread_s=0.1, paused=True, seed=5)
    source.take(start)
    first = said(source, 4)
    done: tuple[hands.Hand, ...] = (
        hands.Pull("tile-04"),
        hands.Freeze("tile-02"),
        hands.Noise(0.1),
    )
    for hand in done:
        source.take(hand)
        first += said(source, 3)
    source.take(commands.Seek(0.0))
    deeds = tuple((time_s, hand) for time_s, hand in zip((0.2, 0.35, 0.5), done, strict=True))
    source.take(commands.Open(FOUR, spread_s=0.1, paused=True, seed=5, deeds=deeds))
    told = of(source.advance(0.0), "deed")
    assert [event["deed"]["do"] for event in told] == ["pull", "freeze", "noise"]
    again = said(source, 13)
    assert of(again, "raw") == of(first, "raw")
    source.take(commands.Seek(0.3))
    source.take(hands.Reset("tile-01"))
    assert [event["deed"] for event in of(source.advance(0.0), "deed")] == [
        {"do": "reset", "port": "tile-01"}
    ]
    source.take(commands.Step(1.0))
    frozen = [event for event in of(source.advance(0.0), "raw") if "$ACK,2" in event["raw"]]
    assert frozen == []  # that would have been in the future that was left


def test_deeds_at_the_beginning_come_before_all(source: EmulatedSource) -> None:
    cells = [list(cell) for cell in FOUR[:2]]
    deeds = ((0.0, hands.Arrange(FOUR[:2])), (0.0, hands.Pull("tile-01")))
    source.take(commands.Open(FOUR, paused=True, deeds=deeds))
    events = source.advance(0.0)
    assert of(events, "deed")[0]["deed"] == {"do": "arrange", "cells": cells}
    assert [event["port"] for event in of(events, "place")] == ["tile-02"]


def test_a_planned_deed_that_cannot_be_done_is_told_once_and_stops_nothing(source: EmulatedSource) -> None:
    deeds = tuple((0.0, hands.Pull(port)) for port in ("tile-99", "tile-01"))
    source.take(commands.Open(FOUR, paused=True, deeds=(*deeds, (0.1, hands.Pull("tile-98")))))
    events = source.advance(0.0)
    assert [event["refused"] for event in of(events, "refused")] == ["no tile tile-99 lies on the board"]
    source.take(commands.Step(0.2))
    assert len(of(source.advance(0.0), "refused")) == 1
    for seconds in (0.0, 0.2):  # the past is run again without them
        source.take(commands.Seek(seconds))
        events = source.advance(0.0)
        assert of(events, "jump")
        assert not of(events, "refused")
