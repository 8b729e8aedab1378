"""How far slow work is: a bar for each piece of it on a terminal's stderr, nothing elsewhere."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

# Takes the name of the piece, the share of it that is done, and a note; a share of 1 or more ends it.
Tell: TypeAlias = Callable[[str, float, str], None]


@contextmanager
def show_progress() -> Iterator[Tell]:
    """Shows what it is told, from any thread, and leaves nothing behind."""
    console = Console(stderr=True)
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TextColumn("{task.fields[note]}", markup=False),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    tasks: dict[str, TaskID] = {}

    def tell(name: str, share: float, note: str) -> None:
        if name not in tasks:
            tasks[name] = bar.add_task(name, total=1.0, note=note)
        bar.update(tasks[name], completed=share, note=note, refresh=share >= 1.0)
        if share >= 1.0:
            bar.remove_task(tasks.pop(name))

    with bar:
        yield tell
