"""Measures the cost of an update on the emulated chip; prints the constants of host/tilenca/model/cost.py.

    python -m firmware.cost_fit

Builds the firmware with networks of several widths, runs each on five tiles in a cross, and fits the time
that the tile in the middle, which has four neighbours, is awake.
"""

import itertools
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from firmware.synthetic_models import network
from tilenca.base import paths
from tilenca.emulator import Array
from tilenca.emulator.wiring import cables
from tilenca.model import cost, render
from tilenca.model.file import Dimensions, Model
from tilenca.protocol.settings import settings_block
from tilenca.shapes.file import Shape

CROSS = Shape("X", (".#.", "###", ".#."), "X")
MIDDLE = 2
WIDTHS = (
    Dimensions(12, 24, 24),
    Dimensions(21, 40, 40),
    Dimensions(21, 40, 80),
    Dimensions(21, 80, 80),
    Dimensions(37, 40, 40),
    Dimensions(37, 64, 64),
    Dimensions(21, 96, 96),
)
PERIODS_MS = (100, 200, 400)
UPDATES = 20
START_S = 1.0
WEIGHT, BIAS = 20, 16000


@dataclass(frozen=True)
class Probe:
    """A network whose zeros are known.

    Attributes:
        active: how many channels, and units of each hidden layer, are not zero after a few updates.
    """

    size: Dimensions
    active: tuple[int, int, int]

    @classmethod
    def of(cls, size: Dimensions, half: bool) -> "Probe":
        """A network without zeros, or one in which half of all values are zero."""
        widths = (size.channels, size.hidden1, size.hidden2)
        return cls(size, ((widths[0] + 1) // 2, widths[1] // 2, widths[2] // 2) if half else widths)

    @property
    def shares(self) -> tuple[float, float, float]:
        """The share of its inputs that each layer sees active."""
        size = self.size
        channels, hidden1, hidden2 = self.active
        return channels / size.channels, hidden1 / size.hidden1, hidden2 / size.hidden2

    def model(self) -> Model:
        """Its weights: signs alternate, so that sums stay small without a proof, and biases decide."""
        size = self.size
        channel = np.arange(size.channels)
        half = self.active[0] < size.channels
        state = np.where(half & (channel % 2 == 1), 0, np.where(channel // 2 % 2 == 0, 1, -1))
        signs = state * np.where((channel // 2 if half else channel) % 2 == 0, 1, -1)
        integer = {
            "w1": np.tile(WEIGHT * signs, (size.hidden1, 5)),
            "w2": np.tile(WEIGHT * alternating(size.hidden1), (size.hidden2, 1)),
            "w3": np.outer(abs(state), WEIGHT * alternating(size.hidden2)),
            "b1": np.where(np.arange(size.hidden1) < self.active[1], BIAS, -BIAS),
            "b2": np.where(np.arange(size.hidden2) < self.active[2], BIAS, -BIAS),
            "b3": state * 32767,
        }
        return network(size, integer)


def environment(**options: Path) -> dict[str, str]:
    """The environment in which PlatformIO builds something else than platformio.ini says."""
    variables = os.environ | {f"PLATFORMIO_{name}": str(value) for name, value in options.items()}
    variables.pop("PLATFORMIO_CORE_DIR", None)
    return variables


def alternating(count: int) -> NDArray[np.int64]:
    """1, -1, 1 ..."""
    return np.where(np.arange(count) % 2 == 0, 1, -1)


def build(model: Model, folder: Path) -> Path:
    """The firmware's ELF with this network, built in `folder`.

    Raises:
        CalledProcessError: it does not build.
    """
    firmware = folder / "firmware"
    shutil.copytree(paths.FIRMWARE, firmware)
    render.write_files(firmware, render.render(model), force=True)
    places = {"SRC_DIR": firmware / "src", "INCLUDE_DIR": firmware / "include", "BUILD_DIR": folder / "build"}
    pio = str(Path(sys.executable).with_name("pio"))
    command = [pio, "run", "-s", "-d", str(paths.ROOT), "-e", paths.FIRMWARE_ENV]
    subprocess.run(command, env=environment(**places), check=True)
    return folder / "build" / paths.FIRMWARE_ENV / "firmware.elf"


def awake(elf: Path, period_ms: int) -> float:
    """Cycles per period that a tile with four neighbours does not sleep."""
    with Array(elf, len(CROSS.cells), cables(CROSS)) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, period_ms, 0))
        array.run(START_S)
        before, asleep_before = array[MIDDLE].cycles
        array.run(UPDATES * period_ms / 1000)
        after, asleep_after = array[MIDDLE].cycles
    return ((after - before) - (asleep_after - asleep_before)) / UPDATES


def main() -> int:
    """Measures, fits, prints."""
    terms, measured = [], []
    for size, half in itertools.product(WIDTHS, (False, True)):
        probe = Probe.of(size, half)
        with tempfile.TemporaryDirectory() as folder:
            elf = build(probe.model(), Path(folder))
            for period_ms in PERIODS_MS:
                weights = cost.weights_read(size, probe.shares)
                terms.append((*weights, size.channels, 1, period_ms))
                measured.append(awake(elf, period_ms))
    table, cycles = np.array(terms, np.float64), np.array(measured)
    # Relative errors, so that a small network counts as much as a large one.
    found = np.linalg.lstsq(table / cycles[:, None], np.ones(len(cycles)), rcond=None)[0]
    for name, value in zip(("MAC", "SKIPPED", "CHANNEL", "UPDATE", "MS"), found, strict=True):
        print(f"CYCLES_PER_{name} = {value:.5g}")
    worst = float(np.abs(table @ found / cycles - 1).max())
    print(f"# {len(cycles)} measurements, the worst is {worst:.2%} off", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
