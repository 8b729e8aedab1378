"""Pictures: their style, how they are written, and trainings over each other. Needs matplotlib.

The same data give the same bytes, with any settings of the user's matplotlib.
"""

import errno
import math
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.project import install_remedy

try:
    from matplotlib import style
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator
except ImportError as error:
    raise UsageError(
        f"plots need matplotlib, which is not installed; run: {install_remedy('plot')}"
    ) from error

# Values in the order of columns; None: not measured there.
Rows: TypeAlias = Sequence[Sequence[float | None]]
WIDEST, THINNER, THINNEST = 3.2, 0.16, 1.2  # lines: the first, each one after it, and none below
SMOOTHED = 60  # lines of fewer points are drawn as they are

SUFFIXES = (".png", ".svg")
WIDTH_IN = 8.0
DPI = 150

INK, FAINT = "#22252b", "#8a9099"
# Okabe and Ito's colours, which differ for every kind of colour vision; each line has its own dashes too.
LINES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", "-.", ":")
STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "text.color": INK,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e7eb",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "svg.hashsalt": "tilenca",
    "svg.fonttype": "path",
}


def styled() -> AbstractContextManager[None]:
    """Our own settings of matplotlib, for as long as the context lasts."""
    return style.context(["default", STYLE])


def save(figure: Figure, path: Path) -> None:
    """Writes a figure; PNG or SVG by the path's suffix, without date and version.

    Raises:
        UsageError: another suffix, or a place where nothing can be written.
        TilencaError: there is no room.
    """
    if path.suffix not in SUFFIXES:
        raise UsageError(f"{path}: pictures are written as {' or '.join(SUFFIXES)}; give a name that ends so")
    metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
    try:
        figure.savefig(path, dpi=DPI, metadata=metadata)
    except OSError as error:
        raise unwritable(path, error) from error


def unwritable(path: Path, error: OSError) -> TilencaError:
    """The error for a picture that cannot be written: no room, or a usage error for its place."""
    if error.errno == errno.ENOSPC:
        return TilencaError(f"{path}: {error.strerror}; free some space and draw again")
    return UsageError(f"{path}: {error.strerror or error}; give a place that can be written")


def plot_runs(runs: Mapping[str, Rows], path: Path) -> None:
    """Draws loss and agreement of several trainings over each other.

    Args:
        runs: by the name that stands for each; rows of (iteration, loss, agreement), None: not measured.
        path: PNG or SVG.

    Raises:
        UsageError: nothing was trained yet, or what `save` says.
    """
    tables = {
        name: np.array([[math.nan if x is None else x for x in row[:3]] for row in rows], np.float64)
        for name, rows in runs.items()
        if len(list(rows))
    }
    if not tables:
        raise UsageError(f"{path}: no training there has a history to draw")
    with styled():
        figure = titled_figure("Trainings", 5.6, 0.08)
        upper, lower = figure.subplots(2, 1, sharex=True)
        for number, (name, table) in enumerate(tables.items()):
            draw_line(upper, table[:, 0], table[:, 1], number, name)
            draw_line(lower, table[:, 0], table[:, 2], number, name)
        as_loss(upper, min(float(np.nanmin(table[:, 1])) for table in tables.values()))
        as_share(lower)
        as_iterations(lower)
        lower.set_ylabel("training samples all right")
        lower.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize="small")
        save(figure, path)


def titled_figure(title: str, height_in: float, apart_in: float) -> Figure:
    """An empty figure of our width, whose panels will lie so far apart."""
    layout = ConstrainedLayoutEngine(w_pad=0.12, h_pad=apart_in)
    figure = Figure(figsize=(WIDTH_IN, height_in), layout=layout)
    figure.suptitle(title, x=0.02, ha="left", fontsize=13, fontweight="bold")
    return figure


def as_loss(axes: Axes, least: float) -> None:
    """A logarithmic axis, unless a loss is 0."""
    if least > 0:
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylabel("loss per tile")


def as_share(axes: Axes, ticks: int = 6) -> None:
    """An axis of shares with so many ticks, 0 and 100 % among them."""
    axes.set_ylim(-0.02, 1.02)
    axes.set_yticks(np.linspace(0, 1, ticks))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0%}"))


def as_iterations(axes: Axes) -> None:
    """An axis of iterations."""
    axes.set_xlabel("iteration")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))


def draw_line(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    number: int,
    label: str | None = None,
    colour: str | None = None,
) -> None:
    """Every point faintly, and their running mean.

    Args:
        axes: where.
        x: of the points.
        y: of the points; those without a number are left out.
        number: decides colour and dashes; a later line is thinner, so that one beneath it still shows.
        label: in the legend.
        colour: another one.
    """
    known = ~np.isnan(y)
    x, y = x[known], y[known]
    colour, dashes = colour or _colour(number), DASHES[number % len(DASHES)]
    few = len(x) < SMOOTHED
    if not few:
        axes.plot(x, y, color=colour, linewidth=0.8, alpha=0.3)
    axes.plot(
        x,
        y if few else _smooth(y, len(y) // (SMOOTHED // 2)),
        color=colour,
        linestyle=dashes,
        linewidth=max(WIDEST - THINNER * number, THINNEST),
        label=label,
        marker="o" if few else "",
        markersize=4,
    )


def _colour(number: int) -> str:
    return LINES[number % len(LINES)]


def _smooth(values: NDArray[np.float64], reach: int) -> NDArray[np.float64]:
    """Means of the values at most `reach` away, fewer at the beginning, where lines are steep."""
    total = np.concatenate(([0.0], np.cumsum(values)))
    at = np.arange(len(values))
    away = np.minimum(at, reach)
    first, end = at - away, np.minimum(at + away + 1, len(values))
    means: NDArray[np.float64] = (total[end] - total[first]) / (end - first)
    return means
