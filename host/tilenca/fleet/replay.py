"""Plays a recording back at its pace or another; a person may pause it, move in it, and end it."""

import time
from collections.abc import Callable, Iterator, Sequence

from tilenca.fleet.state import Event

# An event this near is due: the clock's rounding may never reach a smaller difference.
DUE_S = 1e-3
STEP_S = 10.0
FASTEST, SLOWEST = 1024.0, 1 / 16
KEYS = f"space: pause, left/right: {STEP_S:g} s, up/down: speed, q: quit"


def no_keys(seconds: float) -> Sequence[str]:
    """Waits where there is no keyboard."""
    time.sleep(seconds)
    return ()


class Player:
    """A recording being played; iterate over it once.

    It yields the recording's current time in seconds since 1970 and the events that are due, at least every
    `tick_s`. Events before the start, or before the place that it is moved to, are played at once.
    """

    def __init__(
        self,
        read: Callable[[], Iterator[Event]],
        speed: float,
        tick_s: float,
        start_s: float = 0.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepares to play the events of `read` from `start_s` on, at `speed` (0: without waits)."""
        self._read, self._speed, self._tick_s, self._clock = read, speed, tick_s, clock
        self._paused = self._ended = self._back = False
        self._at_s, self._since_s = start_s, clock()
        self._heeded_s = clock()
        # Set these before it plays: a function that waits for keys, and one to call when it starts again.
        self.wait: Callable[[float], Sequence[str]] = no_keys
        self.begin_again: Callable[[], None] | None = None

    @property
    def position_s(self) -> float:
        """The current position, in seconds since the recording's beginning."""
        passed_s = 0.0 if self._paused else self._clock() - self._since_s
        return self._at_s + passed_s * self._speed

    @property
    def status(self) -> str:
        """The position and the speed, in words."""
        pace = "paused" if self._paused else f"x {self._speed:g}" if self._speed else "at once"
        return f"{self.position_s:.0f} s, {pace}"

    @property
    def keys(self) -> str:
        """Acts on keys; only a recording that can be read again goes back."""
        return KEYS if self.begin_again else KEYS.replace("left/right", "right")

    def __iter__(self) -> Iterator[tuple[float, list[Event]]]:
        while True:
            yield from self._play()
            if self._ended or not self._back:
                return
            self._back = False
            if self.begin_again:
                self.begin_again()

    def _play(self) -> Iterator[tuple[float, list[Event]]]:
        first_s: float | None = None
        for event in self._read():
            first_s = event.time_s if first_s is None else first_s
            while (wait_s := self._wait_s(event.time_s - first_s)) > DUE_S or self._is_time_to_look:
                self._heed(min(wait_s, self._tick_s) if wait_s > DUE_S else 0.0)
                if self._ended or self._back:
                    return
                if wait_s > DUE_S:
                    yield first_s + self.position_s, []
            yield event.time_s, [event]

    def _wait_s(self, offset_s: float) -> float:
        ahead_s = offset_s - self.position_s
        if ahead_s <= 0 or not self._speed:
            return 0.0
        return float("inf") if self._paused else ahead_s / self._speed

    @property
    def _is_time_to_look(self) -> bool:
        """Keys work even while many events are due at once."""
        return self._clock() - self._heeded_s >= self._tick_s

    def _heed(self, seconds: float) -> None:
        keys = self.wait(seconds)
        self._heeded_s = self._clock()
        for key in keys:
            match key:
                case " " if self._speed:
                    self._go_on(self.position_s, paused=not self._paused)
                case "right":
                    self._go_on(self.position_s + STEP_S)
                case "left" if self.begin_again:
                    self._go_on(max(self.position_s - STEP_S, 0.0))
                    self._back = True
                case "up":
                    self._go_on(self.position_s, max(self._speed, min(self._speed * 2, FASTEST)))
                case "down":
                    self._go_on(self.position_s, min(self._speed, max(self._speed / 2, SLOWEST)))
                case "q":
                    self._ended = True

    def _go_on(self, at_s: float, speed: float | None = None, paused: bool | None = None) -> None:
        """Continues from another place, at another speed, or pauses."""
        self._at_s, self._since_s = at_s, self._clock()
        self._speed = self._speed if speed is None else speed
        self._paused = self._paused if paused is None else paused
