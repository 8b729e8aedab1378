"""The lag of emulated tiles behind the wall clock that they should keep up with."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from rich.console import Console
from rich.live import Live

from tilenca.base.stdio import warn

# An emulation that cannot keep up drops the lost time, so that it goes on listening to its ports.
MAX_LAG_S = 0.1
# A lag this small is not reported.
TOLD_S = 0.5
# The time between two reports on the terminal.
LIVE_S = 1.0


class Lag:
    """Adds up the dropped time. Owns no clock."""

    def __init__(self) -> None:
        self.wall_s = self.behind_s = 0.0

    def take(self, wall_s: float) -> float:
        """The emulated time to run for `wall_s` of the wall clock."""
        lived_s = min(wall_s, MAX_LAG_S)
        self.wall_s += wall_s
        self.behind_s += wall_s - lived_s
        return lived_s

    def words(self) -> str:
        """The lag in words; "" for less than half a second."""
        if self.behind_s < TOLD_S:
            return ""
        return (
            f"the tiles are {self.behind_s:.1f} s behind real time: they lived "
            f"{self.wall_s - self.behind_s:.1f} s of {self.wall_s:.1f} s"
        )


@contextmanager
def told(lag: Lag) -> Iterator[Callable[[], None]]:
    """Reports the lag at the end and, on a terminal, while it grows; call the function often."""
    console = Console(stderr=True)
    live = Live(console=console, auto_refresh=False, transient=True, redirect_stdout=False)
    shown_s = 0.0

    def tell() -> None:
        nonlocal shown_s
        if console.is_terminal and lag.wall_s >= shown_s + LIVE_S:
            shown_s = lag.wall_s
            if words := lag.words():
                live.start()
                live.update(words, refresh=True)

    try:
        yield tell
    finally:
        with suppress(OSError):
            live.stop()
        if words := lag.words():
            warn(f"tilenca: {words}; fewer tiles, or a longer --period-ms, need less of this machine")
