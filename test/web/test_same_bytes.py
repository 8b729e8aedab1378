"""WebAssembly and this machine's own code compute the same: every byte of a snapshot."""

import json
import random
from pathlib import Path
from typing import Any

import pytest

from support.avr import build_target
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array, LinkFault
from tilenca.emulator.wiring import cables
from tilenca.shapes.file import Shape
from web.conftest import SOURCES, node

EIGHT = "####\n#..#\n####\n#..#\n####"
SECONDS = 2.0
# All kinds of trouble at once: at a time, what is done, and with what.
EVENTS: list[tuple[float, str, Any]] = [
    (0.0, "noise", [3, 2.0]),
    (0.0, "drift", [5, 40.0]),
    (0.1, "skew", [8, -4000.0]),
    (0.2, "fault", [0, EAST, {"loss": 0.2, "flip": 0.001}]),
    (0.2, "fault", [6, SOUTH, {"flip": 0.01}]),
    (0.3, "fault", [7, WEST, {"loss": 0.5, "delayS": 0.003}]),
    (0.4, "send", [2, "$ASK*43\r\n"]),
    (0.6, "cut", [9, NORTH]),
    (0.8, "power", [11, False]),
    (1.0, "mend", [9, NORTH]),
    (1.1, "press", [1, True]),
    (1.2, "power", [11, True]),
    (1.3, "reset", [4]),
    (1.5, "press", [1, False]),
]


def act(array: Array, name: str, arguments: list[Any], seed: int) -> None:
    """Does what a line of EVENTS says."""
    tile = array[arguments[0]]
    if name == "fault":
        fault = arguments[2]
        link_fault = LinkFault(fault.get("loss", 0), fault.get("flip", 0), fault.get("delayS", 0))
        array.set_fault(arguments[0], arguments[1], link_fault, seed)
    elif name == "cut":
        array.cut(*arguments)
    elif name == "mend":
        array.mend(*arguments)
    elif name == "power":
        tile.powered = arguments[1]
    elif name == "noise":
        tile.set_adc_noise(arguments[1], seed)
    elif name == "skew":
        tile.set_skew(arguments[1])
    elif name == "drift":
        tile.set_drift(arguments[1])
    elif name == "send":
        tile.write_serial(arguments[1].encode())
    elif name == "press":
        tile.press_button(arguments[1])
    else:
        tile.reset()


def native(firmware: Path, ppm: list[float], switch_on_s: list[float], seed: int) -> bytes:
    """The snapshot of this machine's own emulator."""
    links = cables(Shape("8", tuple(EIGHT.split("\n")), "8"))
    with Array(firmware, len(ppm), links, ppm, switch_on_s, translated=False) as array:
        for time_s, name, arguments in EVENTS:
            array.run(max(0.0, time_s - array.time_s))
            act(array, name, arguments, seed)
        array.run(SECONDS - array.time_s)
        return array.save()


@pytest.mark.parametrize("translated", [True, False])
def test_two_seconds_of_an_eight_with_faults_end_in_the_same_bytes(
    bundle: Path, tmp_path: Path, translated: bool
) -> None:
    build_target("tilenca_emulator")
    seed = 20 + translated
    draw = random.Random(seed)
    tiles = EIGHT.count("#")
    ppm = [draw.uniform(-3000, 3000) for _ in range(tiles)]
    switch_on_s = [draw.uniform(0, 0.2) for _ in range(tiles)]
    scenario = {
        "image": str(bundle / "firmware.elf"),
        "drawing": EIGHT,
        "ppm": ppm,
        "switchOnS": switch_on_s,
        "seed": seed,
        "translated": translated,
        "events": [[time_s, name, *arguments] for time_s, name, arguments in EVENTS],
        "seconds": SECONDS,
    }
    (tmp_path / "scenario.json").write_text(json.dumps(scenario))
    snapshot = tmp_path / "snapshot"
    node(SOURCES / "test" / "scenario.js", bundle, tmp_path / "scenario.json", snapshot)
    assert snapshot.read_bytes() == native(bundle / "firmware.elf", ppm, switch_on_s, seed)
