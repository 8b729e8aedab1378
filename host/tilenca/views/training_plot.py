"""The picture of a training: loss, samples, and a panel for each kind of measurement. Needs matplotlib.

Colour and shape mean the same in the picture of every model: a full green point reaches its target, a hollow
red one does not, grey has none. Every line has a panel of its own, so that none hides another.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import UsageError
from tilenca.views.abilities import QUESTIONS, Targets
from tilenca.views.plots import (
    FAINT,
    INK,
    as_iterations,
    as_loss,
    as_share,
    draw_line,
    save,
    styled,
    titled_figure,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HISTORY = ("iteration", "loss", "agreement")
CURVE_IN, PANEL_IN, AROUND_IN = 1.9, 0.62, 0.9  # heights: a curve, a kind of measurement, title and axis
HELD, MISSED = "#009e73", "#d55e00"  # of Okabe and Ito's colours
POINT, LAST = "o", "D"  # measured while training, and the finished model
KEY = "full green: targets held; hollow red: missed; dashes: the least target; diamonds: the finished model"


def plot_history(
    rows: Iterable[Sequence[float | None]],
    path: Path,
    columns: Sequence[str] = HISTORY,
    title: str = "Training",
    targets: Mapping[str, Targets] = MappingProxyType({}),
) -> None:
    """Draws loss, training samples and all measurements over the iterations of a training run.

    Args:
        rows: one per point, values in the order of `columns`; None or NaN: not measured there.
        path: PNG or SVG.
        columns: `iteration`, `loss`, `agreement`, and any number of measured columns named like `@60` or
            `@sizes`; others are left out.
        title: stands above.
        targets: of the kinds of measurement, as the finished model holds them.

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
    measured = {name[1:] for name in columns if name.startswith("@")}
    kinds = sorted({*measured, *targets}, key=_place)
    heights = [CURVE_IN, CURVE_IN, *[PANEL_IN] * len(kinds)]
    with styled():
        figure = titled_figure(title, sum(heights) + AROUND_IN, 0.05)
        panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights, squeeze=False)[:, 0]
        draw_line(panels[0], data["iteration"], data["loss"], 0, colour=INK)
        as_loss(panels[0], float(np.nanmin(data["loss"], initial=math.inf)))
        draw_line(panels[1], data["iteration"], data["agreement"], 0, colour=INK)
        as_share(panels[1])
        panels[1].set_ylabel("training\nsamples right")
        for axes, kind in zip(panels[2:], kinds, strict=True):
            _draw_kind(axes, kind, data["iteration"], data.get(f"@{kind}"), targets.get(kind))
        as_iterations(panels[-1])
        for axes in panels:
            axes.tick_params(labelsize="small")
        if targets:
            figure.supxlabel(KEY, fontsize="small", color=FAINT)
        save(figure, path)


def _draw_kind(
    axes: "Axes",
    kind: str,
    iteration: NDArray[np.float64],
    shares: NDArray[np.float64] | None,
    targets: Targets | None,
) -> None:
    """The smallest share of a kind of measurement over the iterations, and that of the finished model."""
    if shares is not None:
        known = ~np.isnan(shares)
        x, y = iteration[known], shares[known]
        axes.plot(x, y, color=FAINT, linewidth=1.2)
        for here, share in zip(x, y, strict=True):
            _draw_point(axes, here, share, POINT, None if targets is None else bool(share >= targets.least))
    if targets is not None:
        axes.axhline(targets.least, color=INK, linewidth=0.9, linestyle="--")
        _draw_point(axes, iteration[-1], targets.share, LAST, targets.held == targets.given)
    as_share(axes, ticks=2)
    axes.set_title(_name(kind), loc="left", fontsize="small")
    text, colour = _verdict(targets)
    axes.set_title(text, loc="right", fontsize="small", color=colour)


def _draw_point(axes: "Axes", x: float, y: float, marker: str, held: bool | None) -> None:
    colour = {None: FAINT, True: HELD, False: MISSED}[held]
    axes.plot(
        [x],
        [y],
        marker=marker,
        markersize=7 if marker == LAST else 6,
        markeredgewidth=1.5,
        color=colour,
        markerfacecolor="white" if held is False else colour,
        linestyle="",
        clip_on=False,
        zorder=4 if marker == LAST else 3,
    )


def _verdict(targets: Targets | None) -> tuple[str, str]:
    """What stands at the right of a panel, and its colour."""
    if targets is None:
        return "no target", FAINT
    missed = targets.given - targets.held
    text = f"{targets.held} of {targets.given} targets held"
    return (text, HELD) if missed == 0 else (f"{text}, {missed} missed", MISSED)


def _place(kind: str) -> tuple[int, int, str]:
    """Where a kind of measurement stands, which is the same in the picture of every training."""
    kinds, name = list(QUESTIONS), kind.split(" (")[0]
    return (kinds.index(name) if name in kinds else len(kinds), int(kind) if kind.isdigit() else 0, kind)


def _name(kind: str) -> str:
    if kind.isdigit():
        return f"measured after {kind} steps"
    return f"{kind}: {QUESTIONS[kind]}" if kind in QUESTIONS else kind
