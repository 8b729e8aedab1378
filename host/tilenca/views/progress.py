"""How far slow work is: a bar for each piece of it on a terminal's stderr, nothing elsewhere."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeAlias

from rich.console import Console, RenderableType
from rich.progress import BarColumn, Progress, ProgressColumn, TaskID, TextColumn, TimeElapsedColumn

BAR_WIDTH = 24

# Takes the name of the piece, the share of it that is done, and a note; a share of 1 or more ends it.
Tell: TypeAlias = Callable[[str, float, str], None]
# What stands above or below the bars, asked for each time that they are drawn.
Lines: TypeAlias = Callable[[], Sequence[RenderableType]]


def nothing() -> Sequence[RenderableType]:
    """No lines."""
    return ()


class _Framed(Progress):
    """Bars with lines above and below them."""

    def __init__(
        self, above: Lines, below: Lines, *columns: ProgressColumn, console: Console, transient: bool
    ):
        self._above, self._below = above, below
        super().__init__(*columns, console=console, transient=transient, disable=not console.is_terminal)

    def get_renderables(self) -> Iterable[RenderableType]:
        """All that is drawn."""
        yield from self._above()
        yield from super().get_renderables()
        yield from self._below()


class Bars:
    """A title, a bar and a note for each piece of work; from any thread."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._tasks: dict[str, TaskID] = {}

    def __contains__(self, name: str) -> bool:
        return name in self._tasks

    def add(self, name: str, title: str, total: float = 1.0, note: str = "", begun: bool = True) -> None:
        """Adds a piece of work; its time counts from now or, if it has not `begun`, from its first move."""
        self._tasks[name] = self._progress.add_task(title, total=total, note=note, start=begun)

    def move(self, name: str, done: float, note: str) -> None:
        """So much of the piece's total is done."""
        task = self._tasks[name]
        self._progress.start_task(task)
        self._progress.update(task, completed=done, note=note)

    def note(self, name: str, note: str) -> None:
        """Says something of a piece of work, which does not begin by that."""
        self._progress.update(self._tasks[name], note=note)

    def stop(self, name: str) -> None:
        """Its time counts no further."""
        self._progress.stop_task(self._tasks[name])

    def draw(self) -> None:
        """Draws now, not at the next interval."""
        self._progress.refresh()

    def remove(self, name: str) -> None:
        """Takes the bar away, once its end was seen."""
        self._progress.refresh()
        self._progress.remove_task(self._tasks.pop(name))


@contextmanager
def show_bars(
    console: Console,
    width: int = BAR_WIDTH,
    time: type[ProgressColumn] | None = TimeElapsedColumn,
    transient: bool = False,
    above: Lines = nothing,
    below: Lines = nothing,
) -> Iterator[Bars]:
    """Bars while the block runs, if the console is a terminal.

    Args:
        console: where.
        width: of the bars, in characters.
        time: the column that tells the time that passed, or is left; None: there is no room for it.
        transient: whether all of it vanishes at the end.
        above: lines above the bars.
        below: lines below them.
    """
    columns = [
        TextColumn("{task.description}", markup=False),
        BarColumn(width),
        TextColumn("{task.fields[note]}", markup=False),
        *([] if time is None else [time()]),
    ]
    with _Framed(above, below, *columns, console=console, transient=transient) as progress:
        yield Bars(progress)


@contextmanager
def show_progress() -> Iterator[Tell]:
    """Shows what it is told, from any thread, and leaves nothing behind."""
    with show_bars(Console(stderr=True), transient=True) as bars:

        def tell(name: str, share: float, note: str) -> None:
            if name not in bars:
                bars.add(name, name)
            bars.move(name, share, note)
            if share >= 1.0:
                bars.remove(name)

        yield tell
