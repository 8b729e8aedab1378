"""The emulator in the page tells the same as `tilenca page`: every event, for the same commands."""

import json
import random
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from release.page_bundle import offer_of
from support.avr import build_target
from tilenca.base.errors import TilencaError
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.emulated import EmulatedSource
from tilenca.page.offer import load_offer
from tilenca.protocol.stream import StreamEvent, refused_event
from tilenca.protocol.stream_commands import parse_command
from web.conftest import SOURCES, node

EIGHT = [[row, col] for row in range(5) for col in range(4) if row % 2 == 0 or col in (0, 3)]
STEP_S = 0.1
# All that a hand can do, and all kinds of faults; a step after each.
HANDS: list[dict[str, Any]] = [
    {"do": "pace", "speed": 0.1, "paused": True},  # slow: the frames on the cables, too
    {"do": "cut", "port": "tile-03", "side": "W"},
    {"do": "pull", "port": "tile-11"},
    {"do": "noise", "loss": 0.03},
    {"do": "move", "port": "tile-16", "row": 5, "col": 0},
    {"do": "put", "row": 3, "col": 0},
    {"do": "shift", "ports": ["tile-14", "tile-13"], "rows": 2, "cols": -1},
    {"do": "put", "row": 7, "col": 7},
    {"do": "cut", "port": "tile-03", "side": "W", "on": False},
    {"do": "power", "port": "tile-01", "on": False},
    {"do": "turn", "port": "tile-07"},
    {"do": "cut", "port": "tile-07", "side": "E"},
    {"do": "skew", "port": "tile-08", "ppm": 30_000},
    {"do": "pace", "speed": 1, "paused": True},
    {"do": "freeze", "port": "tile-02"},
    {"do": "reset", "port": "tile-05"},
    {"do": "turn", "port": "tile-07", "on": False},
    {"do": "skew", "port": "tile-08", "ppm": 0},
    {"do": "power", "port": "tile-01", "on": True},
    {"do": "freeze", "port": "tile-02", "on": False},
    {"do": "blink", "port": "tile-03", "seconds": 1},
    {"do": "restart", "port": "tile-04"},
    {"do": "set", "name": "brightness", "value": 99},
    {"do": "set", "name": "period", "value": 30, "port": "tile-06"},
    {"do": "arrange", "cells": [[row, col] for row in range(5) for col in range(3)]},
]
MISTAKES: list[dict[str, Any]] = [
    {"do": "put", "row": 0, "col": 0},
    {"do": "put", "row": 65, "col": 0},
    {"do": "pull", "port": "tile-99"},
    {"do": "cut", "port": "tile-01", "side": "N"},
    {"do": "cut", "port": "tile-01", "side": "X"},
    {"do": "power", "port": "tile-01"},
    {"do": "pull", "port": ""},
    {"do": "noise", "loss": 2},
    {"do": "step", "seconds": 99},
    {"do": "move", "port": "tile-01", "row": 0, "col": 0, "why": 1},
    {"do": "shift", "ports": ["tile-01"], "rows": 0, "cols": 1},
    {"do": "shift", "ports": ["tile-01"], "rows": 0, "cols": -65},
    {"do": "shift", "ports": ["tile-01", "tile-99"], "rows": 1, "cols": 0},
    {"do": "shift", "ports": "tile-01", "rows": 1, "cols": 0},
    {"do": "shift", "ports": [""], "rows": 1, "cols": 129},
    {"do": "arrange", "cells": []},
    {"do": "arrange", "cells": [[0, 0], [0]]},
    {"do": "arrange", "cells": [[0, 0]] * 2},
    {"do": "arrange", "cells": [[0, 1.5]]},
    {"do": "open", "cells": [[0, index] for index in range(-64, 64)] + [[1, index] for index in range(17)]},
    {"do": "freeze", "port": "tile-01", "on": 1},
    {"do": "turn", "port": "tile-01", "on": 0},
    {"do": "skew", "port": "tile-01", "ppm": 100_001},
    {"do": "instruct", "port": "tile-09"},
    {"do": "instruct", "port": "tile-01", "count": 1001},
    {"do": "set", "name": "id", "value": 1},
    {"do": "set", "name": "period", "value": 9},
    {"do": "set", "name": "period", "value": 10_001},
    {"do": "set", "name": "brightness", "value": 256},
    {"do": "set", "name": "period", "value": 20, "port": ""},
    {"do": "blink", "port": "tile-01", "seconds": 61},
    {"do": "open", "cells": [[0, 0]], "deeds": [[1, 2]]},
    {"do": "open", "cells": [[0, 0]], "deeds": [[-1, {"do": "pull", "port": "a"}]]},
    {"do": "open", "cells": [[0, 0]], "deeds": [[1, {"do": "pace", "speed": 1}]]},
    {"do": "open", "cells": [[0, 0]], "deeds": [[1, {"do": "pull"}]]},
    {"do": "open", "cells": [[0, 0]], "deeds": [[1, {"do": "open", "cells": 3}]]},
    {"do": "constructor"},
    *({"do": "open", "cells": [[0, 0], [0, 1]], "faults": [fault]} for fault in [
        "fly", "loss", "loss=2", "cut", "cut=1@1", "loss=x", "off@3", "off@1:2-1", "reset@1:1-2", "cut@1N",
        "cut@1:x", "turn", "turn=1@1", "skew=-100001@1", "skew=-x", "loss=-1", "delay=5@1:1:2", "",
    ]),
]  # fmt: skip


def opened(seed: int, **more: Any) -> dict[str, Any]:
    return {"do": "open", "seed": seed, "spread_s": 0.2, "speed": 1, "paused": True, **more}


def native(firmware: Path, commands: list[dict[str, Any]]) -> list[list[StreamEvent]]:
    """What the source of `tilenca page` answers to each command."""
    offer = load_offer()
    source = EmulatedSource(firmware, firmware_settings(firmware), offer.labels, offer.drawings)
    answers = [source.begin()]
    for command in commands:
        refused = []
        try:
            source.take(parse_command(json.dumps(command)))
        except (TilencaError, ValueError) as error:
            refused = [refused_event(0.0, str(error))]
        answers.append(refused + source.advance(0.0))
    source.close()
    return answers


@pytest.fixture
def both(bundle: Path, tmp_path: Path) -> Any:
    """Gives commands to both, who must answer the same, and returns it."""
    build_target("tilenca_emulator")
    offer, file = tmp_path / "offer.json", tmp_path / "commands.json"
    offer.write_text(offer_of(bundle / "firmware.elf"))

    def answers(commands: list[dict[str, Any]]) -> list[list[StreamEvent]]:
        file.write_text(json.dumps(commands))
        theirs = json.loads(node(SOURCES / "test" / "stream.js", bundle, file, offer))
        ours = native(bundle / "firmware.elf", commands)
        for command, mine, other in zip([None, *commands], ours, theirs, strict=True):
            assert other == mine, command
        return ours

    return answers


def labels_at_last(answers: list[list[StreamEvent]]) -> dict[str, str]:
    """The label in the last `$TILE` of each tile."""
    said: dict[str, str] = {}
    for events in answers:
        for event in events:
            if str(event.get("raw", "")).startswith("$TILE"):
                said[event["port"]] = event["raw"].split(",")[4]
    return said


def said_until(answers: list[list[StreamEvent]], time_s: float) -> set[tuple[float, str, str]]:
    """All lines, of which some are told again after a jump."""
    said = [event for events in answers for event in events if "raw" in event]
    return {(event["time"], event["port"], event["raw"]) for event in said if event["time"] < time_s}


@pytest.mark.parametrize("seed", [0, 2**53 - 1])
def test_two_seconds_of_an_eight_are_told_alike(both: Any, seed: int) -> None:
    step = {"do": "step", "seconds": STEP_S}
    answers = both([opened(seed, cells=EIGHT), *[step] * 20])
    told = labels_at_last(answers)
    assert len(told) == len(EIGHT)
    assert sum(len(events) for events in answers) > 600


def test_hands_and_faults_are_told_alike(both: Any) -> None:
    faults = ["flip=0.001@3E", "loss=0.02:0.1-0.6", "delay=3@2:0.2-0.4", "cut@1-2:0.3-0.5", "off@7:0.2-0.8",
              "reset@9:0.4", "drift=400", "drift=90@2", "adc=2", "supply=4.3@4:0.1-0.4",
              "turn@8:0.1-0.3", "skew=-9000@6:0.1-0.4", "skew=500", "remove@5:1.2"]  # fmt: skip
    commands = [opened(7, cells=EIGHT[:10], faults=faults)]
    commands += [{"do": "step", "seconds": 0.05}] * 10 + [
        opened(random.Random(3).randrange(2**53), cells=EIGHT)
    ]
    commands.append({"do": "step", "seconds": 0.4})
    for hand in HANDS:
        commands += [hand, {"do": "step", "seconds": STEP_S}]
    answers = both(commands)
    assert [event["refused"] for events in answers for event in events if "refused" in event] == []
    kinds = {key for events in answers for event in events for key in event}
    assert {"frame", "raw", "place", "cable", "open", "display", "pace", "run"} <= kinds


def test_time_goes_backwards_alike(both: Any) -> None:
    """The same past, the same future with all that hands did, and another one after another deed."""
    step = {"do": "step", "seconds": 0.05}
    commands = [
        opened(11, cells=EIGHT, speed=0.1, faults=["cut@1-2:0.1-0.4", "loss=0.05:0.3-0.6"]),
        *[step] * 6,
    ]
    commands += [
        {"do": "pull", "port": "tile-11"},
        {"do": "turn", "port": "tile-02"},
        {"do": "skew", "port": "tile-03", "ppm": 5000},
        *[step] * 4,
        {"do": "put", "row": 7, "col": 7},
        *[step] * 4,
    ]
    commands += [{"do": "seek", "seconds": 0.21}, *[step] * 11, {"do": "seek", "seconds": 0.5}, step]
    commands += [{"do": "seek", "seconds": 0.0}, *[step] * 2, {"do": "noise", "loss": 0.1}, *[step] * 3]
    commands += [{"do": "seek", "seconds": 9}, {"do": "seek", "seconds": 0.1}, step]
    commands += [{"do": "seek", "seconds": 0.05, "forget": True}, step]
    answers = both(commands)
    after = [events[1:] for events in answers if any("jump" in event for event in events)]
    spoilt = [{event["port"]: event["fault"] for event in events if "fault" in event} for events in after]
    known = {"tile-02": {"turned": True, "skew": 0}, "tile-03": {"turned": False, "skew": 5000}}
    assert spoilt == [{}, known, {}, {}, {}, {}]  # told anew where they stand
    jumps = [event for events in answers for event in events if "jump" in event]
    came_from, went_to = [0.7, 0.76, 0.55, 0.25, 0.25, 0.15], [0.21, 0.5, 0.0, 0.25, 0.1, 0.05]
    assert [event["jump"]["from"] for event in jumps] == pytest.approx(came_from, abs=1e-4)
    assert [event["time"] for event in jumps] == pytest.approx(went_to, abs=1e-4)


def test_planned_deeds_that_cannot_be_done_are_told_and_forgotten_alike(both: Any) -> None:
    deeds = [
        [0, {"do": "pull", "port": "tile-99"}],
        [0.0080083, {"do": "reset", "port": "tile-02"}],  # between two quanta, and half of one apart
        [0.008008, {"do": "pull", "port": "tile-98"}],
        [0.1, {"do": "put", "row": 0, "col": 0}],  # a tile lies there
        [0.1, {"do": "pull", "port": "tile-03"}],  # of the same moment, and done
    ]
    step = {"do": "step", "seconds": 0.1}
    back = [{"do": "seek", "seconds": seconds} for seconds in (0.0, 0.25, 0.05)]
    answers = both([opened(3, cells=EIGHT, deeds=deeds), *[step] * 5, *back, step])
    told = [event["refused"] for events in answers for event in events if "refused" in event]
    assert told[:2] == ["no tile tile-99 lies on the board", "no tile tile-98 lies on the board"]
    assert len(told) == 3, "once each, although the past is run again"
    away = [
        event["port"] for events in answers for event in events if "place" in event and event["place"] is None
    ]
    assert "tile-03" in away


def test_planned_deeds_are_told_alike(both: Any) -> None:
    deeds = [
        [0.31, {"do": "pull", "port": "tile-11"}],
        [0.0, {"do": "put", "row": 9, "col": 9}],
        [0.2, {"do": "freeze", "port": "tile-02"}],
        [0.35, {"do": "arrange", "cells": EIGHT[:9]}],
    ]
    step = {"do": "step", "seconds": 0.1}
    commands = [opened(3, cells=EIGHT, deeds=deeds), *[step] * 5, {"do": "seek", "seconds": 0.25}, step]
    answers = both([*commands, {"do": "noise", "loss": 0.2}, *[step] * 2])
    told = [event["deed"]["do"] for events in answers for event in events if "deed" in event]
    assert told == ["put", "freeze", "pull", "arrange", "noise"]


def test_single_instructions_are_told_alike_and_change_nothing(both: Any) -> None:
    """Registers, variables and stack; the run goes on as it would have done."""
    step = {"do": "step", "seconds": 0.1}
    begin = [opened(5, cells=EIGHT[:6], speed=0.1), step, step, step]
    single = [
        {"do": "instruct", "port": "tile-02", "count": 0},
        *[{"do": "instruct", "port": "tile-02"}] * 8,
        {"do": "instruct", "port": "tile-03", "count": 700},
        {"do": "instruct", "port": "tile-02", "count": 1000},
    ]
    end = [{"do": "seek", "seconds": 9}, step, {"do": "noise", "loss": 0.1}, step]
    answers = both([*begin, *single, *end])
    chips = [event["chip"] for events in answers for event in events if "chip" in event]
    assert len(chips) == len(single)
    assert len({chip["pc"] for chip in chips[:9]}) > 4
    assert [later["cycles"] > sooner["cycles"] for sooner, later in pairwise(chips[:9])] == [True] * 8
    names = [name for name, *_ in chips[0]["variables"]]
    assert "tilenca_sending" in names
    assert any(chip["function"] for chip in chips)
    without = both([opened(5, cells=EIGHT[:6], speed=0.1), *[step] * 4])
    assert said_until(answers, 0.39) == said_until(without, 0.39)
    assert len(said_until(without, 0.39)) > 10


def test_mistakes_are_refused_alike(both: Any) -> None:
    before, after = both([MISTAKES[0]])[1], both([opened(1, cells=EIGHT[:4]), *MISTAKES])[2:]
    assert before[0]["refused"] == "nothing runs yet; open a drawing first"
    assert [bool(events[0].get("refused")) for events in after] == [True] * len(MISTAKES)
