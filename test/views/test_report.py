"""The figures of the report."""

from dataclasses import replace
from xml.etree import ElementTree

from tilenca.report.document import Figure
from tilenca.report.rows import SHARE, STEPS, Row
from tilenca.report.words import Mark
from tilenca.views.report import draw_figure


def row(across: float, value: float | None, low: float | None = None, high: float | None = None) -> Row:
    return Row("k", "what", value, SHARE, low, high, 10, 1, "tilenca", across=across)


def test_a_figure_is_an_element_of_svg_the_same_every_time() -> None:
    lines = {
        "size 5x4": [row(0, 1.0, 0.9, 1.0), row(0.5, 0.2, 0.1, 0.3)],
        "curve": [row(0, 0.3), row(1, None)],
    }
    figure = Figure("edges", "messages lost", "share", lines)
    svg = draw_figure(figure)
    assert svg == draw_figure(figure)
    root = ElementTree.fromstring(svg)
    assert root.tag.endswith("svg")
    assert len(svg) < 60_000


def test_what_others_do_is_marked_with_their_names_and_times_need_no_share() -> None:
    lines = {"": [replace(row(0.1, 7.0), unit=STEPS), replace(row(0.9, 12.0), unit=STEPS)]}
    marks = (Mark(0.1, 0.2, "others"), Mark(0.5, None, "bricks"))
    plain = draw_figure(Figure("edges", "updates", "periods", lines))
    marked = draw_figure(Figure("edges", "updates", "periods", lines, marks=marks))
    assert ElementTree.fromstring(marked).tag.endswith("svg")
    assert len(marked) > len(plain)
