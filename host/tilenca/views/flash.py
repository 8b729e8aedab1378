"""The progress of programming boards: a bar for each and one for all, or plain lines."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars

from tilenca.base.stdio import warn
from tilenca.fleet.avrdude import Progress

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


class _Bars:
    """Progress as one bar per board, and one for all of them."""

    def __init__(self, bars: Bars, titles: Mapping[str, str]) -> None:
        self._bars = bars
        self._tasks = {
            name: bars.add_task(escape(title), total=1.0, start=False, phase="waiting")
            for name, title in titles.items()
        }
        self._all = bars.add_task("all", total=float(len(titles)), phase="") if len(titles) > 1 else None
        self._shares = dict.fromkeys(titles, 0.0)
        self._done = 0

    def show(self, name: str, progress: Progress) -> None:
        task = self._tasks[name]
        start, width = SPANS[progress.phase]
        self._bars.start_task(task)
        self._move(name, start + width * progress.share, progress.phase)

    def done(self, name: str, result: str, error: str | None) -> None:
        self._done += 1
        self._move(name, 1.0 if error is None else self._shares[name], result)
        self._bars.stop_task(self._tasks[name])

    def _move(self, name: str, share: float, phase: str) -> None:
        self._shares[name] = share
        self._bars.update(self._tasks[name], completed=share, phase=phase)
        if self._all is not None:
            about = f"{self._done} of {len(self._tasks)} done"
            self._bars.update(self._all, completed=sum(self._shares.values()), phase=about)


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
    columns = [
        TextColumn("{task.description}"),
        BarColumn(LEAST_BAR if narrow else WIDE_BAR),
        *([] if narrow else [TimeElapsedColumn()]),
        TextColumn("{task.fields[phase]}"),
    ]
    room = console.width - (LEAST_BAR + PHASE if narrow else WIDE_BAR + TIME + PHASE)
    with Bars(*columns, console=console) as bars:
        yield _Bars(bars, {name: ending(title, room) for name, title in titles.items()})
