"""What hands did, in words: one line for each moment, of every kind of deed."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.page_node import PageNode

SCRIPT = """
import { deedMoments, isDeed } from "./stream/deeds.js";
const answer = (deeds) => [deedMoments(deeds), deeds.every(({ deed }) => isDeed(deed))];
"""
DEEDS: dict[str, tuple[dict[str, Any], str]] = {
    "put": ({"row": 1, "col": 2}, "a tile put in"),
    "pull": ({"port": "tile-04"}, "tile 4 pulled out"),
    "move": ({"port": "tile-04", "row": 1, "col": 2}, "tile 4 moved"),
    "shift": ({"ports": ["tile-04", "tile-05"], "rows": 1, "cols": 0}, "2 tiles moved together"),
    "arrange": ({"cells": [[0, 0]]}, "another drawing, of 1 tile"),
    "cut": ({"port": "tile-04", "side": "N", "on": True}, "cable cut at tile 4, north"),
    "power": ({"port": "tile-04", "on": False}, "tile 4 switched off"),
    "freeze": ({"port": "tile-04", "on": True}, "tile 4 frozen"),
    "turn": ({"port": "tile-04", "on": False}, "tile 4 turned back"),
    "skew": ({"port": "tile-04", "ppm": -300}, "the clock of tile 4 300 ppm too slow"),
    "reset": ({"port": "tile-04"}, "tile 4 reset"),
    "noise": ({"loss": 0.025}, "2.5 % of the bytes lost"),
    "blink": ({"port": "tile-04", "seconds": 3}, "tile 4 blinks"),
    "restart": ({"port": "tile-04"}, "the button of tile 4 pressed"),
    "set": ({"name": "period", "value": 40, "port": None}, "period 40 set at all tiles"),
}


@pytest.fixture
def page(tmp_path: Path) -> Iterator[PageNode]:
    with PageNode(tmp_path, SCRIPT) as running:
        yield running


def test_each_deed_has_words(page: PageNode) -> None:
    deeds = [
        {"time": second + 1, "deed": {"do": name, **fields}}
        for second, (name, (fields, _)) in enumerate(DEEDS.items())
    ]
    moments, are_deeds = page.ask(deeds)
    assert are_deeds
    assert [one["words"] for one in moments] == [words for _, words in DEEDS.values()]


def test_what_was_done_while_time_stood_is_one_and_the_beginning_is_none(page: PageNode) -> None:
    pulls = [
        {"time": time, "deed": {"do": "pull", "port": f"tile-{n:02d}"}}
        for n, time in enumerate([0, 2, 2, 2, 3])
    ]
    moments, _ = page.ask(pulls)
    assert moments == [
        {"time": 2, "words": "tile 1 pulled out, tile 2 pulled out, 1 more"},
        {"time": 3, "words": "tile 4 pulled out"},
    ]
