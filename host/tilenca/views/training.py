"""How training looks: a bar for every seed on a terminal, a line a minute elsewhere; both on stderr."""

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from functools import partial

from rich.console import Console
from rich.progress import TimeRemainingColumn

from tilenca.training.progress import Progress, Tell
from tilenca.views.curve import Curve
from tilenca.views.progress import show_bars

LINE_EVERY_S = 60.0  # of each seed, where there is no terminal
PREPARING = "preparing the drawings that it is trained on and measured with"
ROWS = 10  # of a measurement per line, likewise


@contextmanager
def show_training(seeds: Sequence[int], total: int) -> Iterator[Tell]:
    """Shows the progress that it is told.

    Args:
        seeds: who trains.
        total: iterations of each.
    """
    console = Console(stderr=True)
    curve = agreement_curve(total)
    lines = partial(curve.lines, console.options.ascii_only)
    with show_bars(console, time=TimeRemainingColumn, below=lines) as bars:
        for seed in seeds:
            bars.add(f"{seed}", f"seed {seed}", total, f"0/{total}  {PREPARING}", begun=False)
        first: dict[int, tuple[float, int]] = {}
        printed: dict[int, float] = {}

        def tell(news: Progress) -> None:
            if news.seed not in first:
                first[news.seed] = time.monotonic(), news.iteration
            now_s = time.monotonic()
            curve.add(news.iteration, news.agreement)
            begun, iteration = first[news.seed]
            rate = (news.iteration - iteration) / max(now_s - begun, 1e-9)
            bars.move(f"{news.seed}", news.iteration, f"{news.iteration}/{total}  {_note(news, rate)}")
            due = news.rows is None and now_s - printed.get(news.seed, -LINE_EVERY_S) >= LINE_EVERY_S
            due |= news.rows is None and news.iteration == total
            if not console.is_terminal and due:
                printed[news.seed] = now_s
                left_s = (total - news.iteration) / rate if rate else None
                left = f"; {_left(news, left_s)}" if left_s is not None and news.iteration < total else ""
                print(f"seed {news.seed}: {reached(news, total)}{left}", file=sys.stderr, flush=True)

        yield tell


@contextmanager
def show_measuring(where: str, count: int) -> Iterator[Callable[[str], None]]:
    """Shows how far the last measurement is, by the rows that it is told.

    Args:
        where: their file.
        count: of all rows.
    """
    console = Console(stderr=True)
    begin = f"measuring the model, a minute or a few; every row will be in {where}"
    told = 0
    with console.status(f"{begin}\n{row_text(0, count)}") as status:
        if not console.is_terminal:
            print(begin, file=sys.stderr, flush=True)

        def tell(row: str) -> None:
            nonlocal told
            told += 1
            status.update(f"{begin}\n{row_text(told, count)}; {row}")
            if not console.is_terminal and told % ROWS == 0:
                print(row_text(told, count), file=sys.stderr, flush=True)

        yield tell


@dataclass(frozen=True)
class TrainingViews:
    """What a person sees of a training; by default what is in this module.

    Attributes:
        training: as `show_training`.
        measuring: as `show_measuring`.
    """

    training: Callable[[Sequence[int], int], AbstractContextManager[Tell]] = field(
        default_factory=lambda: show_training
    )
    measuring: Callable[[str, int], AbstractContextManager[Callable[[str], None]]] = field(
        default_factory=lambda: show_measuring
    )


def row_text(done: int, count: int) -> str:
    """How far a measurement is, in words."""
    return f"{done} of {count} rows measured"


def agreement_curve(total: int) -> Curve:
    """The curve of a training with so many iterations, of all its seeds together."""
    return Curve(total, f"share of the drawings with every tile right, over {total:,} iterations")


def reached(news: Progress, total: int) -> str:
    """The progress as a sentence, for a person and a log."""
    line = f"{news.iteration} of {total} iterations; all tiles right on {news.agreement:.0%} of the drawings"
    if news.rows is not None:
        line += f"; measuring, {row_text(*news.rows)}"
    if news.check is not None:
        held, asked, _ = news.check
        line += f"; on the way {held} of {asked} targets met"
    return line


def _left(news: Progress, left_s: float) -> str:
    left = "less than a minute" if left_s < 60 else f"about {left_s / 60:.0f} min"
    return f"{left} left{', less if the targets hold early' if news.check else ''}"


def _note(news: Progress, rate: float) -> str:
    if news.rows is not None:
        return f"measuring, {row_text(*news.rows)}"
    note = f"loss {news.loss:.4f}  all right {news.agreement:.1%}  {rate:.0f}/s"
    if news.check is not None:
        held, asked, shortfall = news.check
        note += f"  on the way {held} of {asked} targets met"
        note += f", {shortfall:.3f} short" if shortfall else ""
    return note
