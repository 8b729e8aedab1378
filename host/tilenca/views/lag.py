"""The lag of emulated tiles, as people see it: on a terminal while it grows, and at the end."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from rich.console import Console
from rich.live import Live

from tilenca.base.stdio import warn
from tilenca.emulator.lag import Lag

# The time between two reports on the terminal.
LIVE_S = 1.0


@contextmanager
def show_lag(lag: Lag) -> Iterator[Callable[[], None]]:
    """Reports the lag at the end and, on a terminal, while it grows; the caller calls the function often."""
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
