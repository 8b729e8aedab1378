"""The recordings that the page reads: any text is shown to its end, or refused with a reason, by the page and
by the command that hands it one.
"""

import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.page_node import PageNode
from support.strategies import damaged
from tilenca.base.errors import UsageError
from tilenca.page.recording_file import check_recording

READ = """
import { parseRecording } from "./stream/recording_file.js";
import { deedMoments } from "./stream/deeds.js";
import { Tiles } from "./stream/tiles.js";
function answer(text) {
  let events;
  try {
    ({ events } = parseRecording(text));
  } catch (error) {
    return { refused: error instanceof Error ? error.message : `${error}` };
  }
  const tiles = new Tiles();
  try {
    tiles.take(events);
    tiles.laid().forEach((tile) => [0, 1, 2, 3].map((side) => tiles.cableAt(tile, side)));
    deedMoments(tiles.deeds);
  } catch (error) {
    return { broken: error.stack };
  }
  return { shown: events.length };
}
"""
LOOK = {"label": "1", "segments": 6, "rgb": [9, 9, 0]}
EVENTS: list[dict[str, Any]] = [
    {"time": 0, "stream": 1, "source": "emulated", "looks": [LOOK], "most_tiles": 9, "most_place": 9,
     "models": [{"name": "a", "id": "1F", "labels": ["1"]}], "period_ms": 20,
     "drawings": [{"name": "a/1", "label": "1", "rows": ["#", "#"]}]},
    {"time": 0, "run": {"seed": 1, "began": 3}},
    {"time": 0, "port": "tile-01", "place": [0, 1]},
    {"time": 0, "port": "tile-01", "open": True, "reason": ""},
    {"time": 0.1, "port": "tile-01", "side": "E", "cable": "cut"},
    {"time": 0.1, "port": "tile-01", "fault": {"turned": True, "skew": 3}},
    {"time": 0.2, "port": "tile-01", "raw": "$TILE,1,1200,12,4,4,30,N-SW,80FF*00"},
    {"time": 0.2, "port": "tile-01", "display": {"segments": 6, "rgb": [0, 9, 0], "leds": "N--W"}},
    {"time": 0.3, "port": "tile-01", "side": "N", "frame": "0102"},
    {"time": 0.4, "port": "tile-01", "health": {"trouble": "", "links": {"N": ["good", 0.5]}}},
    {"time": 0.4, "port": "tile-01", "note": "shows 1"},
    {"time": 0.4, "deed": {"do": "put", "row": 1}},
    {"time": 0.4, "deed": {"do": "arrange", "cells": [[0, 1], [1, 1]]}},
    {"time": 0.4, "deed": {"do": "shift", "ports": ["tile-01"], "rows": 1, "cols": 0}},
    {"time": 0.4, "deed": {"do": "noise", "loss": 0.1}},
    {"time": 0.5, "classes": [LOOK]},
    {"time": 0.5, "refused": "no"},
    {"time": 0.5, "pace": {"speed": 1, "end": 0.5}},
    {"time": 0.5, "jump": {"from": 0.1}},
]  # fmt: skip
WHOLE = "".join(f"{json.dumps(event)}\n" for event in EVENTS)
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageNode]:
    with PageNode(tmp_path_factory.mktemp("page"), READ) as node:
        yield node


def check(page: PageNode, text: str) -> None:
    [(what, told)] = page.ask(text).items()
    assert what in ("shown", "refused"), told
    assert what == "shown" or (0 < len(told) < 200 and "\n" not in told), told
    assert is_taken(text) == (what == "shown"), told


def test_one_of_record_is_told_as_such(page: PageNode) -> None:
    first = {"time": 1, "port": "tile-01", "place": [0, 0], "tile": 1, "shape": "4"}
    assert page.ask(json.dumps(first))["refused"].startswith("it is of --record, and not of the page")


def is_taken(text: str) -> bool:
    """Whether `tilenca page --replay` takes a recording of the page."""
    try:
        check_recording(Path("r.jsonl"), io.StringIO(text, newline="\n").readlines())
    except UsageError:
        return False
    return True


def test_a_recording_with_every_kind_of_event_is_shown(page: PageNode) -> None:
    assert page.ask(WHOLE) == {"shown": len(EVENTS)}
    assert is_taken(WHOLE)


@settings(max_examples=300)
@given(damaged(WHOLE.encode()))
def test_any_bytes_are_shown_or_refused(page: PageNode, content: bytes) -> None:
    check(page, content.decode("utf-8", "replace"))


@settings(max_examples=300)
@given(st.data())
def test_any_value_in_an_event_is_shown_or_refused(page: PageNode, data: st.DataObject) -> None:
    events: list[Any] = json.loads(json.dumps(EVENTS))
    place: Any = events
    while True:
        key = data.draw(st.sampled_from(list(place) if isinstance(place, dict) else list(range(len(place)))))
        inner = place[key]
        if not (isinstance(inner, dict | list) and inner) or data.draw(st.booleans()):
            break
        place = inner
    place[key] = data.draw(json_values)
    check(page, "".join(f"{json.dumps(event)}\n" for event in events))
