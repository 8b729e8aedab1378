"""Stepping back in time: snapshots of an array as it runs, and the way from the nearest one."""

from bisect import bisect_right

from tilenca.base.errors import UsageError
from tilenca.emulator.array import Array

QUANTUM_S = 16e-6


class History:
    """Runs an array and remembers how it was.

    What is done to tiles from outside (buttons, serial bytes, cables) is in the snapshots after it, but it is
    not done again on the way from one before it.

        history = History(array, every_s=0.1)
        history.run(5.0)
        history.go_to(3.21)
    """

    def __init__(self, array: Array, every_s: float = 0.1, most: int = 100) -> None:
        """Remembers the present.

        Args:
            array: what to run; use `run` of this object from now on.
            every_s: emulated seconds between two snapshots.
            most: how many to keep; the oldest go first. Each takes about 15 KB a tile.
        """
        if every_s <= 0 or most < 1:
            raise UsageError(f"a history of {most} moments, {every_s} s apart; both must be positive")
        self._array, self._every_s, self._most = array, every_s, most
        self._snapshots: list[tuple[float, bytes]] = [(array.time_s, array.save())]

    @property
    def moments_s(self) -> list[float]:
        """The times that there are snapshots of, in seconds since the array began."""
        return [time_s for time_s, _ in self._snapshots]

    def run(self, seconds: float) -> None:
        """Runs on, as `Array.run` does."""
        end_s = self._array.time_s + seconds
        while self._array.time_s < end_s - QUANTUM_S / 2 and not self._array.halted:
            next_s = self._snapshots[-1][0] + self._every_s
            self._array.run(max(min(next_s, end_s) - self._array.time_s, QUANTUM_S))
            if self._array.time_s >= next_s:
                self._snapshots.append((self._array.time_s, self._array.save()))
                del self._snapshots[: -self._most]

    def go_to(self, time_s: float) -> None:
        """Goes to a moment of the past, or on to one that is to come; later moments are forgotten.

        Raises:
            UsageError: the moment is older than all that is kept.
        """
        if time_s > self._array.time_s:
            self.run(time_s - self._array.time_s)
            return
        kept = bisect_right(self.moments_s, time_s)
        if kept == 0:
            oldest_s = self._snapshots[0][0]
            raise UsageError(f"{time_s} s: the oldest moment kept is {oldest_s:.6f} s; keep more of them")
        del self._snapshots[kept:]
        from_s, snapshot = self._snapshots[-1]
        self._array.restore(snapshot)
        if time_s > from_s:
            self._array.run(time_s - from_s)
