"""The figures of the report: shares along an axis, with their intervals. Needs matplotlib."""

import io
import re
from collections.abc import Mapping, Sequence

import numpy as np

from tilenca.report.document import Figure
from tilenca.report.rows import SHARE, Row
from tilenca.report.words import Mark
from tilenca.views.plots import DASHES, FAINT, INK, LINES, styled

# After `plots`, which says what is missing where matplotlib is.
from matplotlib.axes import Axes  # isort: skip
from matplotlib.figure import Figure as Canvas  # isort: skip

SIZE_IN = (4.6, 3.1)
MOST_EVEN = 50  # times as far as the first value, up to which an axis is linear


def draw_figure(figure: Figure) -> str:
    """A figure as SVG, without the head of a file: an element to put into a page."""
    with styled():
        canvas = Canvas(figsize=SIZE_IN, layout="constrained")
        axes = canvas.add_subplot()
        _draw(axes, figure.rows)
        _mark(axes, figure.marks)
        axes.set_xlabel(figure.axis)
        buffer = io.StringIO()
        canvas.savefig(buffer, format="svg", metadata={"Date": None})
    return re.sub(r"^.*?(?=<svg)", "", buffer.getvalue(), count=1, flags=re.DOTALL).strip()


def _draw(axes: Axes, lines: Mapping[str, Sequence[Row]]) -> None:
    for number, (name, rows) in enumerate(lines.items()):
        colour, dash = LINES[number % len(LINES)], DASHES[number % len(DASHES)]
        across, value, low, high = (
            np.array([getattr(row, name) for row in rows], np.float64)  # nan for none
            for name in ("across", "value", "low", "high")
        )
        axes.plot(across, value, dash, color=colour, label=name)
        axes.fill_between(across, low, high, color=colour, alpha=0.15, linewidth=0)
    places = sorted({row.across for rows in lines.values() for row in rows if row.across})
    if places[-1] > MOST_EVEN * places[0]:
        axes.set_xscale("symlog", linthresh=places[0])
    if all(row.unit == SHARE for rows in lines.values() for row in rows):
        axes.set_ylim(-0.03, 1.03)
    else:
        axes.set_ylim(bottom=0)
    if any(lines):
        axes.legend()


def _mark(axes: Axes, marks: Sequence[Mark]) -> None:
    """What others do: a cross where they say a share, a line up to which they say that they hold."""
    for mark in marks:
        if mark.value is None:
            axes.axvline(mark.across, color=FAINT, linewidth=1, linestyle=":")
            place = (mark.across, 1.0)
        else:
            axes.plot([mark.across], [mark.value], "x", color=INK)
            place = (mark.across, mark.value)
        axes.annotate(mark.label, place, (4, 3), textcoords="offset points", color=INK, fontsize=8)
