"""The frames on the cables of an array, while cables come and go."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass

from tilenca.base.errors import UsageError
from tilenca.base.sides import SOUTH
from tilenca.emulator.array import Array, Link
from tilenca.emulator.probe import WireTap


@dataclass(frozen=True)
class CableFrame:
    """A frame that has passed along a cable.

    Attributes:
        time_s: when it ended, in seconds since the array began.
        tile: that it left, counted from 0.
        side: of that tile.
        data: the bytes, without delimiter.
    """

    time_s: float
    tile: int
    side: int
    data: bytes


class Traffic:
    """Listens at cables, in both directions."""

    def __init__(self, array: Array, cables: Iterable[Link] = ()) -> None:
        self._array = array
        self._taps: dict[tuple[int, int], WireTap] = {}
        self._midway: set[tuple[int, int]] = set()
        for cable in cables:
            self.watch(cable)

    def watch(self, cable: Link) -> None:
        """Listens at a cable from now on; a side without USART is read at the cable's other end."""
        for tile, side, other, other_side in (cable, (*cable[2:], *cable[:2])):
            if side == SOUTH:
                tap = self._array[other].tap(other_side, receiving=True)
            else:
                tap = self._array[tile].tap(side)
            self._taps[tile, side] = tap

    def forget(self, cable: Link) -> None:
        """Listens no more at a cable."""
        for end in (cable[:2], cable[2:]):
            self._midway.discard(end)
            if tap := self._taps.pop(end, None):
                tap.close()

    def restart(self, cables: Iterable[Link]) -> None:
        """The array has gone to another moment, with these cables; a frame may be on its way there."""
        for tap in self._taps.values():
            with suppress(UsageError):  # its tile is no more
                tap.close()
        self._taps = {}
        for cable in cables:
            self.watch(cable)
        self._midway = set(self._taps)

    def read(self) -> list[CableFrame]:
        """The frames that have ended since the last call, in order of their ends."""
        seen = []
        for end, tap in self._taps.items():
            frames = tap.read_frames()
            if frames and end in self._midway:
                self._midway.discard(end)
                del frames[0]  # its beginning is missing
            seen += [CableFrame(frame.time_s, *end, frame.data) for frame in frames]
        return sorted(seen, key=lambda frame: (frame.time_s, frame.tile, frame.side))
