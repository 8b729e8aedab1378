"""The past of a run: moments to go back to, and what hands did when. Owns no tiles."""

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from tilenca.emulator.history import QUANTUM_S

Moment = TypeVar("Moment")
Deed = TypeVar("Deed")

# Emulated seconds between two moments, where there is room: the most that is run again to come to a time.
EVERY_S = 0.05
MOST_BYTES = 64_000_000


@dataclass(frozen=True)
class _Kept(Generic[Moment]):
    time_s: float
    moment: Moment
    size: int


class Timeline(Generic[Moment, Deed]):
    """Moments and deeds in their order of time, up to `end_s`, which the run has reached once.

    Moments lie closest where the run is now: where room is short, those go that leave the smallest gap for
    their age. The first one stays, so that every time of the run can be reached.

    Attributes:
        end_s: the time that the run has reached; beyond it nothing is known.
    """

    def __init__(
        self,
        deeds: Iterable[tuple[float, Deed]] = (),
        every_s: float = EVERY_S,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        """Nothing has run yet; `deeds`, in order of time, are to be done."""
        self._every_s, self._most_bytes = every_s, most_bytes
        self._kept: list[_Kept[Moment]] = []
        self._deeds = list(deeds)
        self.end_s = 0.0

    # --- while it runs ---

    def is_due(self, now_s: float) -> bool:
        """Whether a moment should be kept now."""
        before = bisect_right(self._kept, now_s + QUANTUM_S / 2, key=_time)
        return before == 0 or now_s - self._kept[before - 1].time_s >= self._every_s - QUANTUM_S / 2

    def keep(self, now_s: float, moment: Moment, size: int) -> None:
        """Keeps a moment of so many bytes."""
        self._kept.insert(bisect_right(self._kept, now_s, key=_time), _Kept(now_s, moment, size))
        self.end_s = max(self.end_s, now_s)
        while len(self._kept) > 2 and sum(kept.size for kept in self._kept) > self._most_bytes:
            del self._kept[self._least(now_s)]

    def _least(self, now_s: float) -> int:
        """The moment that is missed least: neither the first nor the last."""

        def gap(place: int) -> float:
            before, after = self._kept[place - 1].time_s, self._kept[place + 1].time_s
            return (after - before) / (abs(now_s - before) + self._every_s)

        return min(range(1, len(self._kept) - 1), key=gap)

    def note(self, now_s: float, deed: Deed) -> None:
        """A hand has done something: from here on it is another future, and the one that was known is void.

        The moment of now is void, too: keep it anew, with what the hand has done.
        """
        self.end_at(now_s)
        self._kept = [kept for kept in self._kept if kept.time_s < now_s - QUANTUM_S / 2]
        self._deeds.append((now_s, deed))

    def end_at(self, now_s: float) -> None:
        """What was known and planned beyond is void."""
        self._deeds = [(time_s, one) for time_s, one in self._deeds if time_s <= now_s + QUANTUM_S / 2]
        self._kept = [kept for kept in self._kept if kept.time_s <= now_s + QUANTUM_S / 2]
        self.end_s = now_s

    def forget(self, planned: tuple[float, Deed]) -> None:
        """A deed that cannot be done is not done again."""
        self._deeds = [one for one in self._deeds if one is not planned]

    def reached(self, now_s: float) -> None:
        """The run has come to a time."""
        self.end_s = max(self.end_s, now_s)

    # --- in the past ---

    def deeds_in(self, from_s: float, to_s: float) -> list[tuple[float, Deed]]:
        """What hands did after a time, up to another."""
        half = QUANTUM_S / 2
        return [one for one in self._deeds if from_s + half < one[0] <= to_s + half]

    def nearest(self, time_s: float) -> tuple[float, Moment]:
        """The last moment before a time, or the first of all."""
        place = max(bisect_right(self._kept, time_s + QUANTUM_S / 2, key=_time), 1) - 1
        return self._kept[place].time_s, self._kept[place].moment

    @property
    def moments_s(self) -> list[float]:
        """The times of the moments."""
        return [kept.time_s for kept in self._kept]


def _time(kept: _Kept[Moment]) -> float:
    return kept.time_s
