"""Stepping back in time: snapshots of a running array, and a replay from the nearest one."""

from bisect import bisect_right

from tilenca.base.errors import UsageError
from tilenca.emulator.array import Array

QUANTUM_S = 16e-6


class History:
    """Runs an array and keeps snapshots of it.

    Snapshots contain earlier actions from outside (buttons, serial bytes, cables), but a replay from an
    earlier snapshot does not repeat them.

        history = History(array, every_s=0.1)
        history.run(5.0)
        history.go_to(3.21)
    """

    def __init__(self, array: Array, every_s: float = 0.1, most: int = 100) -> None:
        """Takes the first snapshot.

        Args:
            array: to run; use `run` of this object from now on.
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
        """Goes back to a past moment, or forward to a later one; snapshots after it are dropped.

        Raises:
            UsageError: the moment is older than every kept snapshot.
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
