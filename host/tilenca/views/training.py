"""How training looks: a bar for every seed on a terminal, a line now and then elsewhere; both on stderr."""

import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from tilenca.training.progress import Progress as News
from tilenca.training.progress import Tell

LINES = 10  # per seed, where there is no terminal


@contextmanager
def show_training(seeds: Sequence[int], total: int) -> Iterator[Tell]:
    """Shows the progress that it is told.

    Args:
        seeds: who trains.
        total: iterations of each.
    """
    console = Console(stderr=True)
    bar = Progress(
        TextColumn("seed {task.description}"),
        BarColumn(bar_width=24),
        TextColumn("{task.completed}/{task.total}  {task.fields[note]}"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
    with bar:
        tasks = {seed: bar.add_task(str(seed), total=total, note="", start=False) for seed in seeds}
        first: dict[int, tuple[float, int]] = {}
        printed = dict.fromkeys(seeds, 0)

        def tell(news: News) -> None:
            if news.seed not in first:
                first[news.seed] = time.monotonic(), news.iteration
                bar.start_task(tasks[news.seed])
            begun, iteration = first[news.seed]
            rate = (news.iteration - iteration) / max(time.monotonic() - begun, 1e-9)
            note = _note(news, rate)
            bar.update(tasks[news.seed], completed=news.iteration, note=note)
            if not console.is_terminal and news.iteration * LINES // total > printed[news.seed]:
                printed[news.seed] = news.iteration * LINES // total
                print(f"seed {news.seed}: {news.iteration}/{total}  {note}", file=sys.stderr, flush=True)

        yield tell


def _note(news: News, rate: float) -> str:
    note = f"loss {news.loss:.4f}  agree {news.agreement:.3f}  {rate:.0f}/s"
    if news.check is not None:
        held, asked, shortfall = news.check
        note += f"  targets {held}/{asked}, short by {shortfall:.3f}"
    return note
