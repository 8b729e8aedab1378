"""The frames on the cables of an array, while cables come and go."""

from collections.abc import Iterable
from dataclasses import dataclass

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
            if tap := self._taps.pop(end, None):
                tap.close()

    def read(self) -> list[CableFrame]:
        """The frames that have ended since the last call, in order of their ends."""
        seen = [
            CableFrame(frame.time_s, tile, side, frame.data)
            for (tile, side), tap in self._taps.items()
            for frame in tap.read_frames()
        ]
        return sorted(seen, key=lambda frame: (frame.time_s, frame.tile, frame.side))
