"""The facts that an emulated tile reports."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import IntEnum

SRAM_END = 0x2200


class ResetCause(IntEnum):
    """The cause of a reset from outside; the bit of MCUSR that reports it."""

    EXTERNAL = 2
    BROWN_OUT = 4


@dataclass(frozen=True)
class Stack:
    """A tile's stack, in addresses of data memory.

    Attributes:
        pointer: the stack pointer.
        deepest: the lowest address the stack has used since the tile was switched on.
        floor: the lowest address it may use: the data, and the heap, end below.
    """

    pointer: int
    deepest: int
    floor: int

    @property
    def most_bytes(self) -> int:
        """The largest size of the stack so far."""
        return SRAM_END - self.deepest


@dataclass(frozen=True)
class Mark:
    """A marked instruction began.

    Attributes:
        function: the function it is in.
        address: its byte address in flash.
        cycle: of the tile's own clock, since it was first switched on.
    """

    function: str
    address: int
    cycle: int


@dataclass(frozen=True)
class DisplayChange:
    """A change of a tile's display.

    Attributes:
        time_s: seconds since the array began, to 256 us.
        segments: bit mask as in `tilenca.shapes.glyphs`.
    """

    time_s: float
    segments: int


def port_name(index: int) -> str:
    """The name of a tile's serial port, numbered from 1 in reading order."""
    return f"tile-{index + 1:02d}"


def port_index(name: str) -> int:
    """The index of the tile with that port."""
    return int(name.removeprefix("tile-")) - 1


def last_begun(changes: Iterable[DisplayChange], shows: Callable[[int], bool]) -> float:
    """When a display last began to show something, in seconds; 0 where it never did.

    Args:
        changes: of the display, in order.
        shows: whether these lit segments are it.
    """
    begun_s, shown = 0.0, False
    for change in changes:
        if shows(change.segments) and not shown:
            begun_s = change.time_s
        shown = shows(change.segments)
    return begun_s
