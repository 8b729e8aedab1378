"""Pictures for reports: the course of a training, and the tiles while they converge. Needs matplotlib.

The same data give the same bytes, with any settings of the user's matplotlib.
"""

import errno
import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.project import install_remedy
from tilenca.views.abilities import QUESTIONS, Targets

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
HISTORY = ("iteration", "loss", "agreement")
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


def plot_history(
    rows: Iterable[Sequence[float | None]],
    path: Path,
    columns: Sequence[str] = HISTORY,
    title: str = "Training",
    targets: Mapping[str, Targets] = MappingProxyType({}),
) -> None:
    """Draws loss and agreement over the iterations of a training run.

    Args:
        rows: one per point, values in the order of `columns`; None or NaN: not measured there.
        path: PNG or SVG.
        columns: `iteration`, `loss`, `agreement`, and any number of measured columns named like `@60` or
            `@sizes`; others are left out.
        title: stands above.
        targets: of the measured columns, by their names without `@`; the least one of each is a mark at the
            right edge, and the legend says how many the model holds in the end.

    Raises:
        UsageError: no rows, a column is missing, or what `save` says.
    """
    table = np.array([[math.nan if x is None else x for x in row] for row in rows], np.float64)
    missing = [name for name in HISTORY if name not in columns]
    if missing:
        raise UsageError(
            f"{path}: the history has no column '{missing[0]}' to draw; it has: {' '.join(columns)}"
        )
    if len(table) == 0:
        raise UsageError(f"{path}: the history has no rows to draw; train for more iterations")
    data = dict(zip(columns, table.T, strict=True))
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 5.6), layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.08))
        upper, lower = figure.subplots(2, 1, sharex=True)
        figure.suptitle(title, x=0.02, ha="left", fontsize=13, fontweight="bold")
        _draw_loss(upper, data["iteration"], data["loss"])
        _draw_agreement(lower, data, targets)
        save(figure, path)


def plot_runs(runs: Mapping[str, Rows], path: Path) -> None:
    """Draws loss and agreement of several trainings over each other.

    Args:
        runs: by the name that stands for each; rows of (iteration, loss, agreement), as of `plot_history`.
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
        figure = Figure(figsize=(WIDTH_IN, 5.6), layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.08))
        upper, lower = figure.subplots(2, 1, sharex=True)
        figure.suptitle("Trainings", x=0.02, ha="left", fontsize=13, fontweight="bold")
        for number, (name, table) in enumerate(tables.items()):
            _draw_line(upper, table[:, 0], table[:, 1], number, name)
            _draw_line(lower, table[:, 0], table[:, 2], number, name)
        _as_loss(upper, min(float(np.nanmin(table[:, 1])) for table in tables.values()))
        _as_agreement(lower)
        lower.set_ylabel("training samples all right")
        lower.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize="small")
        save(figure, path)


def _draw_loss(axes: Axes, iteration: NDArray[np.float64], loss: NDArray[np.float64]) -> None:
    _draw_line(axes, iteration, loss, 0)
    _as_loss(axes, float(np.nanmin(loss, initial=math.inf)))


def _as_loss(axes: Axes, least: float) -> None:
    """A logarithmic axis, unless a loss is 0."""
    if least > 0:
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylabel("loss per tile")


def _draw_agreement(axes: Axes, data: dict[str, NDArray[np.float64]], targets: Mapping[str, Targets]) -> None:
    _draw_line(axes, data["iteration"], data["agreement"], 0, "training samples", INK)
    measured = sorted((_place(name[1:]), name) for name in data if name.startswith("@"))
    for place, name in measured:
        target = targets.get(name[1:])
        _draw_line(axes, data["iteration"], data[name], place, _question(name[1:]) + _held(target))
        if target is not None:
            edge = axes.get_yaxis_transform()
            axes.plot(
                [1.0],
                [target.least],
                marker=5,
                markersize=9,
                color=_colour(place),
                transform=edge,
                clip_on=False,
            )
    if measured:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=3, fontsize="small")
    _as_agreement(axes)


def _held(target: Targets | None) -> str:
    return "" if target is None else f": {target.held} of {target.given} targets"


def _as_agreement(axes: Axes) -> None:
    axes.set_ylim(-0.02, 1.02)
    axes.set_ylabel("share with every tile right")
    axes.set_xlabel("iteration")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0%}"))


def _place(name: str) -> int:
    """The number of a kind of measurement, which is the same in the picture of every training."""
    kinds = list(QUESTIONS)
    return kinds.index(name) if name in kinds else len(kinds) + (int(name) if name.isdigit() else 0)


def _question(name: str) -> str:
    return f"measured after {name} steps" if name.isdigit() else name


def _draw_line(
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
