"""Emulated tiles: whole ATmega2560 boards, wired side to side, running a firmware image cycle by cycle.

The work is done by the C++ library that `make setup` builds from tools/emulator; this is its Python
interface::

    from tilenca.emulator import EAST, WEST, Array
    from tilenca.base.paths import FIRMWARE_ELF

    with Array(FIRMWARE_ELF, tiles=2, links=[(0, EAST, 1, WEST)], ppm=[1000, -1000]) as array:
        array.run(1.0)
        print(array[0].segments, array[1].rgb, array[0].read_serial())

Everything is deterministic: the same calls give the same results, to the cycle, on any number of threads.
docs/EMULATOR.md has more examples, and says what of the chip is modelled.
"""

from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator.array import Array, FaultCounts, Link, LinkFault
from tilenca.emulator.hardware import IDEAL, Hardware
from tilenca.emulator.library import LIBRARY
from tilenca.emulator.probe import Edge, PinProbe, Waveforms, WireByte, WireFrame, WireTap
from tilenca.emulator.tile import EEPROM_BYTES, EmulatedTile
from tilenca.emulator.types import DisplayChange, Mark, ResetCause, Stack

__all__ = [
    "EAST", "EEPROM_BYTES", "IDEAL", "LIBRARY", "NORTH", "SOUTH", "WEST", "Array", "DisplayChange", "Edge",
    "EmulatedTile", "FaultCounts", "Hardware", "Link", "LinkFault", "Mark", "PinProbe", "ResetCause", "Stack",
    "Waveforms", "WireByte", "WireFrame", "WireTap",
]  # fmt: skip
