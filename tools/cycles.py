"""Measures what an update costs on the emulated chip, and prints the constants of host/tilenca/fit.py.

    python tools/cycles.py

Builds the firmware with networks of several widths, lets five tiles in a cross run them, and fits how long
the one in the middle, which has four neighbours, is awake.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca import export, fit, paths
from tilenca.emulation import cables
from tilenca.emulator import Array
from tilenca.glyphs import GLYPHS
from tilenca.modelfile import Dimensions, Model
from tilenca.protocol import settings_block
from tilenca.shapes import Shape

CROSS = Shape("X", (".#.", "###", ".#."), "X")
MIDDLE = 2
WIDTHS = (
    Dimensions(12, 24, 24),
    Dimensions(21, 40, 40),
    Dimensions(21, 40, 80),
    Dimensions(21, 80, 80),
    Dimensions(37, 40, 40),
    Dimensions(37, 64, 64),
)
PERIODS_MS = (100, 200, 400)
CLASSES = 10
UPDATES = 20
START_S = 1.0


def any_model(size: Dimensions) -> Model:
    """A network of random weights: what they are makes no difference to the time they take."""
    random = np.random.default_rng(0)
    integer: dict[str, NDArray[Any]] = {
        name: random.integers(-40, 41, shape).astype(np.int8 if name.startswith("w") else np.int16)
        for name, shape in size.shapes().items()
    }
    floats = {name: array.astype(np.float32) for name, array in integer.items()}
    return Model(tuple(GLYPHS)[:CLASSES], size, integer, floats)


def environment(**options: Path) -> dict[str, str]:
    """What PlatformIO is started with, so that it builds something else than platformio.ini says."""
    variables = os.environ | {f"PLATFORMIO_{name}": str(value) for name, value in options.items()}
    variables.pop("PLATFORMIO_CORE_DIR", None)
    return variables


def build(size: Dimensions, folder: Path) -> Path:
    """The firmware's ELF with a network of these widths, built in `folder`.

    Raises:
        CalledProcessError: it does not build.
    """
    firmware = folder / "firmware"
    shutil.copytree(paths.FIRMWARE, firmware)
    export.write_files(firmware, export.render(any_model(size)), force=True)
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
    for size in WIDTHS:
        with tempfile.TemporaryDirectory() as folder:
            elf = build(size, Path(folder))
            for period_ms in PERIODS_MS:
                outputs = size.hidden1 + size.hidden2 + size.channels
                terms.append((fit.macs(size), outputs, size.channels, 1, period_ms))
                measured.append(awake(elf, period_ms))
    table, cycles = np.array(terms, np.float64), np.array(measured)
    # Relative errors, so that a small network counts as much as a large one.
    found = np.linalg.lstsq(table / cycles[:, None], np.ones(len(cycles)), rcond=None)[0]
    for name, value in zip(("MAC", "OUTPUT", "CHANNEL", "UPDATE", "MS"), found, strict=True):
        print(f"CYCLES_PER_{name} = {value:.5g}")
    worst = float(np.abs(table @ found / cycles - 1).max())
    print(f"# {len(cycles)} measurements, the worst is {worst:.2%} off", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
