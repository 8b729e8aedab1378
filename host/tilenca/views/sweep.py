"""Pictures of a sweep's table: curves with intervals, times to agreement, heat maps. Needs matplotlib."""

from collections.abc import Callable, Iterable, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from tilenca.base.errors import UsageError
from tilenca.views.plots import DASHES, INK, LINES, save, styled

# After `plots`, which says what is missing where matplotlib is.
from matplotlib import colormaps  # isort: skip
from matplotlib.axes import Axes  # isort: skip
from matplotlib.figure import Figure  # isort: skip
from matplotlib.ticker import FuncFormatter  # isort: skip

CURVES, TIMES, HEAT = "curves.svg", "times.svg", "heat.svg"
MOST_PANELS, MOST_LINES = 12, 12
PANEL_IN, HEIGHT_IN = 3.9, 3.4
COLUMNS = 3
WRITTEN = 14  # values along an axis of a heat map up to which each share is written into it
COLOURS = "cividis"  # even for every kind of colour vision

Row = dict[str, Any]


def draw_sweep(rows: Sequence[Row], axes: Sequence[str], folder: Path) -> list[Path]:
    """Draws a table.

    Args:
        rows: of `tilenca.sweep.table`; each cell's last row has all its drawings.
        axes: the names of those with several values, in the order of the command: the first one with numbers
            goes to the right, the next one is a curve for each value (or up, in a heat map), and each
            combination of the others has a picture of its own.
        folder: for `curves.svg`, `times.svg`, and with two axes of numbers `heat.svg`.

    Raises:
        UsageError: there is no axis of numbers, or too many curves or pictures; the message says what to do.
    """
    names = [name.replace("-", "_") for name in axes]
    cells = _cells(rows, names)
    numeric = [name for name in names if all(isinstance(row[name], float) for row in cells)]
    if not numeric:
        raise UsageError(
            "--plot needs an axis with several numbers, such as loss=0:0.6:0.1; the table is there"
        )
    across = numeric[0]
    others = [name for name in names if name != across]
    up = next((name for name in others if name in numeric), others[0] if others else None)
    panels = [name for name in others if name != up]
    values = _values(cells, up) if up else [None]
    count = int(np.prod([len(_values(cells, name)) for name in panels]))
    if len(values) > MOST_LINES or count > MOST_PANELS:
        raise UsageError(
            f"--plot draws at most {MOST_LINES} curves in {MOST_PANELS} pictures; give fewer values"
        )

    def curve(axes: Axes, mine: Sequence[Row]) -> None:
        _draw_lines(axes, mine, across, up, values, _draw_share)

    def time(axes: Axes, mine: Sequence[Row]) -> None:
        _draw_lines(axes, mine, across, up, values, _draw_time)

    def heat(axes: Axes, mine: Sequence[Row]) -> None:
        _draw_heat(axes, mine, across, str(up))

    pictures = [(CURVES, "All tiles right", curve), (TIMES, "Steps until all tiles are right, median", time)]
    if up in numeric:
        pictures.append((HEAT, "Share of the runs with all tiles right", heat))
    return [_draw(cells, panels, title, draw, folder / name) for name, title, draw in pictures]


def _cells(rows: Sequence[Row], names: Sequence[str]) -> list[Row]:
    """The last row of every cell."""
    last = {tuple(row[name] for name in names): row for row in rows}
    return list(last.values())


def _values(cells: Iterable[Row], name: str) -> list[Any]:
    return list(dict.fromkeys(row[name] for row in cells))


def _draw(
    cells: Sequence[Row],
    panels: Sequence[str],
    title: str,
    draw: Callable[[Axes, Sequence[Row]], None],
    path: Path,
) -> Path:
    choices = list(product(*(_values(cells, name) for name in panels)))
    columns = min(COLUMNS, len(choices))
    lines = -(-len(choices) // columns)
    with styled():
        figure = Figure(figsize=(PANEL_IN * columns + 0.6, HEIGHT_IN * lines + 0.6), layout="constrained")
        grid = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
        figure.suptitle(title, x=0.02, ha="left", fontsize=13, fontweight="bold")
        for axes in grid.flat[len(choices) :]:
            axes.set_visible(False)
        for axes, choice in zip(grid.flat, choices, strict=False):
            mine = [row for row in cells if tuple(row[name] for name in panels) == choice]
            draw(axes, mine)
            axes.set_title(
                ", ".join(
                    f"{_words(name)} {_text(value)}" for name, value in zip(panels, choice, strict=True)
                )
            )
        handles, labels = grid.flat[0].get_legend_handles_labels()
        if len(labels) > 1:
            figure.legend(
                handles, labels, loc="outside lower center", ncols=min(6, len(labels)), fontsize="small"
            )
        save(figure, path)
    return path


def _draw_lines(
    axes: Axes,
    mine: Sequence[Row],
    across: str,
    up: str | None,
    values: Sequence[Any],
    draw: Callable[[Axes, Sequence[Row], str, dict[str, Any]], None],
) -> None:
    for number, value in enumerate(values):
        line = [row for row in mine if up is None or row[up] == value]
        few = len(values) <= len(LINES)
        colour = LINES[number] if few else colormaps[COLOURS](number / len(values))
        label = None if up is None else f"{_words(up)} {_text(value)}"
        draw(axes, line, across, {"color": colour, "linestyle": DASHES[number % len(DASHES)], "label": label})
    axes.set_xlabel(_words(across))


def _draw_share(axes: Axes, line: Sequence[Row], across: str, look: dict[str, Any]) -> None:
    """The share with its interval."""
    x = [row[across] for row in line]
    axes.fill_between(
        x, [row["low"] for row in line], [row["high"] for row in line], color=look["color"], alpha=0.2
    )
    axes.plot(x, [row["share"] for row in line], linewidth=1.8, marker="o", markersize=3, **look)
    axes.set_ylim(-0.02, 1.02)
    axes.set_ylabel("share of the runs")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0%}"))


def _draw_time(axes: Axes, line: Sequence[Row], across: str, look: dict[str, Any]) -> None:
    """The median; nothing where half of the runs never agree."""
    y = [np.nan if row["median"] is None else row["median"] for row in line]
    axes.plot([row[across] for row in line], y, linewidth=1.8, marker="o", markersize=3, **look)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("steps")


def _draw_heat(axes: Axes, mine: Sequence[Row], across: str, up: str) -> None:
    columns, lines = _values(mine, across), _values(mine, up)
    share = {(row[up], row[across]): row["share"] for row in mine}
    grid = np.array([[share[line, column] for column in columns] for line in lines])
    axes.imshow(grid, cmap=COLOURS, vmin=0, vmax=1, origin="lower", aspect="auto")
    axes.grid(visible=False)
    axes.set_xticks(
        range(len(columns)), [_text(value) for value in columns], rotation=90 if len(columns) > 8 else 0
    )
    axes.set_yticks(range(len(lines)), [_text(value) for value in lines])
    axes.set_xlabel(_words(across))
    axes.set_ylabel(_words(up))
    if max(grid.shape) <= WRITTEN:
        for (line, column), value in np.ndenumerate(grid):
            colour = INK if value > 0.6 else "white"
            axes.text(column, line, f"{value:.2f}", ha="center", va="center", color=colour, fontsize=7)


def _words(name: str) -> str:
    return {"loss": "messages lost", "dead": "tiles dead", "flip": "bits inverted"}.get(
        name, name.replace("_", " ")
    )


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
