"""A recording: the history is that of the run, in whatever order one goes through it."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from support.page_node import PageNode

SCRIPT = """
import { openRecording } from "./stream/recording.js";
import { Tiles } from "./stream/tiles.js";

let frame = null;
globalThis.requestAnimationFrame = (call) => (frame = call, 1);

function answer([recorded, times]) {
  const tiles = new Tiles();
  const source = openRecording(recorded, { onEvents: (events) => tiles.take(events) });
  let now = performance.now();
  const paint = () => frame((now += 10));
  source.send({ do: "open", speed: 1 });
  source.send({ do: "pace", speed: 1, paused: true });
  paint();
  const told = times.map((seconds) => {
    if (seconds === null) source.send({ do: "step", seconds: 0.5 });
    else source.send({ do: "seek", seconds });
    paint();
    const { history, time } = tiles;
    const samples = history.samples.filter((sample) => sample.time <= time);
    const counted = samples.map(({ time, counts }) => [time, ...counts]);
    const shown = tiles.laid().map(({ label }) => label);
    const deeds = tiles.deeds.map((one) => one.time);
    return [time, history.changesUntil(time), counted, shown, deeds];
  });
  return told;
}
"""


def raw(time: float, port: str, label: str) -> dict[str, object]:
    said = f"TILE,1,7,7,{label},4,3,----,80"
    check = 0
    for byte in said.encode():
        check ^= byte
    return {"time": time, "port": port, "raw": f"${said}*{check:02X}"}


# One tile changes its mind every second, the other one never does.
RECORDED = [
    {"time": 0, "stream": 1, "source": "emulated"},
    {"time": 0, "run": {"seed": 1, "shape": "-", "tiles": 2}},
    *(
        event
        for col, port in enumerate(("tile-01", "tile-02"))
        for event in ({"time": 0, "port": port, "place": [0, col]}, {"time": 0, "port": port, "open": True})
    ),
    raw(0.5, "tile-02", "0"),
    *(raw(0.5 + second, "tile-01", str(second % 10)) for second in range(20)),
    {"time": 7, "deed": {"do": "pull", "port": "tile-03"}},
    {"time": 20, "pace": {"speed": 1, "paused": True, "share": 1, "end": 20}},
]
RECORDED[2:] = sorted(RECORDED[2:], key=lambda event: event["time"])  # type: ignore[arg-type,return-value]


@pytest.fixture
def page(tmp_path: Path) -> Iterator[PageNode]:
    with PageNode(tmp_path, SCRIPT) as running:
        yield running


def test_any_order_of_jumps_gives_the_history_of_the_run(page: PageNode) -> None:
    stepped = page.ask([RECORDED, [None] * 40])
    true = {time: rest for time, *rest in stepped}
    assert [true[time][0] for time in (1, 5, 13.5, 20)] == [0, 4, 13, 19]
    for order in ([13.5], [3, 13.5, 1, 20, 5], [20, 0.5, 10], [10, 2, None, 13.5, None, 4, None, 19]):
        for time, *rest in page.ask([RECORDED, order]):
            assert json.dumps(rest) == json.dumps(true[time]), f"{order} at {time}"


def test_the_last_changes_of_mind_are_a_part_of_the_run(tmp_path: Path) -> None:
    script = """
import { History } from "./stream/history.js";
function answer([times, until]) {
  const history = new History();
  for (const time of times) history.note({ time, port: "t", from: "1", to: "2" });
  history.note({ time: 9, port: "t", from: "", to: "2" });
  return history.lastBurst(until);
}
"""
    with PageNode(tmp_path, script) as page:
        assert page.ask([[], 9]) is None
        part = page.ask([[0.05, 1, 1.4, 1.8, 5], 4])
        assert part == {"from": pytest.approx(0.9), "to": pytest.approx(1.9)}
        assert page.ask([[0.05, 1], 0.1]) == {"from": 0, "to": 0.1}


def test_deeds_are_known_once_from_the_beginning(page: PageNode) -> None:
    for told in page.ask([RECORDED, [2, 9, 1, 8]]):
        assert told[-1] == [7]
