"""The progress of programming boards: a bar for each and one for all, or plain lines."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import TimeElapsedColumn

from tilenca.base.stdio import warn
from tilenca.fleet.avrdude import Progress
from tilenca.views.progress import Bars, show_bars

# Where on the bar each phase starts, and how much of it the phase takes.
SPANS = {
    "asking": (0.0, 0.0),
    "connecting": (0.0, 0.0),
    "trying again": (0.0, 0.0),
    "writing": (0.0, 0.5),
    "verifying": (0.5, 0.45),
    "confirming": (0.95, 0.0),
}

# How wide the columns are, gaps included, and from what width of the terminal on there is room for all.
PHASE, TIME, LEAST_BAR, WIDE_BAR = 14, 8, 8, 30
NARROW = 90
ALL = "all"  # the bar of all boards together; no port has such a name
LEAST_TITLE = 12


class Display(Protocol):
    """Shows the progress of boards."""

    def show(self, name: str, progress: Progress) -> None:
        """Shows the progress of the board at port `name`."""

    def done(self, name: str, result: str, error: str | None) -> None:
        """The board is finished in this run."""


class _Lines:
    """Progress as plain lines: one for every change of a board's phase."""

    def __init__(self, titles: Mapping[str, str]) -> None:
        self._titles, self._said, self._done = titles, dict[str, str](), 0

    def show(self, name: str, progress: Progress) -> None:
        self._say(name, progress.phase)

    def done(self, name: str, result: str, error: str | None) -> None:
        self._done += 1
        count = f" ({self._done} of {len(self._titles)} done)"
        self._say(name, (result if error is None else f"{result}: {error}") + count)

    def _say(self, name: str, text: str) -> None:
        if self._said.get(name) != text:
            self._said[name] = text
            warn(f"{self._titles[name]}: {text}")


class _BoardBars:
    """Progress as one bar per board, and one for all of them."""

    def __init__(self, bars: Bars, titles: Mapping[str, str]) -> None:
        self._bars = bars
        for name, title in titles.items():
            bars.add(name, title, note="waiting", begun=False)
        self._has_total = len(titles) > 1
        if self._has_total:
            bars.add(ALL, ALL, total=float(len(titles)))
        self._shares = dict.fromkeys(titles, 0.0)
        self._done = 0

    def show(self, name: str, progress: Progress) -> None:
        start, width = SPANS[progress.phase]
        self._move(name, start + width * progress.share, progress.phase)

    def done(self, name: str, result: str, error: str | None) -> None:
        self._done += 1
        self._move(name, 1.0 if error is None else self._shares[name], result)
        self._bars.stop(name)

    def _move(self, name: str, share: float, phase: str) -> None:
        self._shares[name] = share
        self._bars.move(name, share, phase)
        if self._has_total:
            about = f"{self._done} of {len(self._shares)} done"
            self._bars.move(ALL, sum(self._shares.values()), about)


def ending(title: str, room: int) -> str:
    """As much of a title as fits: its end, which tells one board from another."""
    room = max(room, LEAST_TITLE)
    return title if len(title) <= room else "..." + title[3 - room :]


@contextmanager
def display(titles: Mapping[str, str]) -> Iterator[Display]:
    """Shows progress on stderr while the block runs; `titles` are the names of the ports."""
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal or console.is_dumb_terminal:
        yield _Lines(titles)
        return
    narrow = console.width < NARROW
    room = console.width - (LEAST_BAR + PHASE if narrow else WIDE_BAR + TIME + PHASE)
    width, time = (LEAST_BAR, None) if narrow else (WIDE_BAR, TimeElapsedColumn)
    with show_bars(console, width, time) as bars:
        yield _BoardBars(bars, {name: ending(title, room) for name, title in titles.items()})
