"""The report as a page and as Markdown."""

from dataclasses import replace

from tilenca.report.document import (
    Facts,
    figures_of,
    gap_of,
    interval_text,
    render,
    sections_of,
    value_text,
    verdict,
)
from tilenca.report.experiments import EDGES, GAP, PAPER, Experiment
from tilenca.report.rows import SECONDS, SHARE, Row

AGAIN = "tilenca sweep --axis loss=0.1"
ROW = Row("edges.loss.0", "messages lost: loss 0.1", 0.5, SHARE, 0.4, 0.6, 100, 1, AGAIN)
FACTS = Facts("tilenca report --out x", "1", "D968", "2026-01-01", "a machine", quick=True)
EXPERIMENTS = [
    Experiment(
        "edges.loss", EDGES, "messages lost", (), "sweep", (1, 1), figure="messages lost", axis="share"
    ),
    Experiment("paper.curve", PAPER, "'4'", (), "curve", (1, 1), figure="update by update", axis="updates"),
    Experiment("gap.fast.60", GAP, "fast", (), "evaluation", (1, 1)),
    Experiment("gap.tiles.60", GAP, "<tiles>", (), "evaluation", (1, 1)),
]
ROWS = {
    "edges.loss": [replace(ROW, across=0.2, line="size 5x4"), replace(ROW, across=0.1, line="size 5x4")],
    "paper.curve": [replace(ROW, key="curve", what="a curve", across=1, line="'4'")],
    "gap.fast.60": [replace(ROW, key="gap.fast.60.right", value=1.0)],
    "gap.tiles.60": [replace(ROW, key="gap.tiles.60.right", what="<tiles>", value=0.98, target=0.99)],
}


def test_a_figure_has_the_rows_of_its_experiments_along_their_axis() -> None:
    first, second = figures_of(EXPERIMENTS, ROWS)
    assert (first.section, first.title, first.axis) == (EDGES, "messages lost", "share")
    assert [row.across for row in first.rows["size 5x4"]] == [0.1, 0.2]
    assert list(second.rows) == ["'4'"]


def test_numbers_are_written_as_people_read_them() -> None:
    assert (value_text(ROW), interval_text(ROW), verdict(ROW)) == ("0.500", "0.400 to 0.600", "")
    time = replace(ROW, value=1.25, unit=SECONDS, low=None, high=None)
    assert (value_text(time), interval_text(time)) == ("1.25 s", "")
    assert value_text(replace(ROW, value=None)) == "never"
    assert [verdict(replace(ROW, target=target)) for target in (0.5, 0.6)] == ["held", "missed"]


def test_both_documents_have_every_row_but_those_of_curves_and_nothing_from_elsewhere() -> None:
    figures = [replace(figure, svg="<svg></svg>") for figure in figures_of(EXPERIMENTS, ROWS)]
    sections = sections_of(EXPERIMENTS, ROWS, figures)
    page, text = (
        render(template, FACTS, sections, gap_of(ROWS)) for template in ("page.html.j2", "results.md.j2")
    )
    for document in (page, text):
        assert "differ by 2.0 points" in document
        assert "a curve" not in document
        assert "0.990 missed" in document
    assert page.count("<svg></svg>") == 2
    assert "&lt;tiles&gt;" in page
    assert "<tiles>" not in page
    assert AGAIN in page
    assert "http" not in page
    assert "![messages lost](images/results-edges-1.svg)" in text
