"""The report as a page and as Markdown."""

from dataclasses import replace

from tilenca.report.document import (
    Facts,
    Gap,
    apart_of,
    figures_of,
    gap_of,
    interval_text,
    render,
    sections_of,
    value_text,
    verdict,
)
from tilenca.report.experiment import Experiment
from tilenca.report.experiments import EDGES, GAP, PAPER
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
    "paper.curve": [replace(ROW, key="curve", what="a curve", across=1, line="'4'", only_drawn=True)],
    "gap.fast.60": [replace(ROW, key="gap.fast.60.right", value=1.0)],
    "gap.tiles.60": [replace(ROW, key="gap.tiles.60.right", what="<tiles>", value=0.98, target=0.99)],
}


def test_a_figure_has_the_rows_of_its_experiments_along_their_axis() -> None:
    first, second = figures_of(EXPERIMENTS, ROWS)
    assert (first.section, first.title, first.axis) == (EDGES, "messages lost", "share")
    assert [row.across for row in first.rows["size 5x4"]] == [0.1, 0.2]
    assert list(second.rows) == ["'4'"]


def test_the_heat_maps_of_an_experiment_are_in_both_documents_with_their_numbers() -> None:
    place = {"loss": "0.1", "dead": "0.3", "size": "5x4"}
    some = [
        replace(ROW, value=value, place=place | {"dead": dead})
        for dead, value in (("0.3", 0.75), ("0.4", 0.25))
    ]
    heat = Experiment("edges.loss-dead", EDGES, "both", (), "sweep", (1, 1), figure="runs: both", heat=True)
    (figure,) = figures_of([heat], {heat.key: some})
    assert not figure.rows
    sections = sections_of([heat], {heat.key: some}, [figure])
    page, text = (
        render(template, FACTS, sections, Gap(None)) for template in ("page.html.j2", "results.md.j2")
    )
    assert '<td class="number" style="--share: 0.75"' in page
    assert "<caption>Size 5x4</caption>" in page
    assert "| dead \\ loss | 0.1 |\n|---|---|\n| 0.3 | 0.750 |\n| 0.4 | 0.250 |\n" in text
    assert "<svg" not in page
    assert ".svg" not in text


def test_simulator_and_tiles_are_compared_update_by_update() -> None:
    def curve(engine: str, *shares: float) -> dict[str, list[Row]]:
        drawn = [replace(ROW, value=share, across=step) for step, share in enumerate(shares, 1)]
        return {f"gap.{engine}.60": [replace(ROW, across=None), *drawn]}

    apart = apart_of(curve("timed", 0.1, 0.5, 0.9) | curve("tiles", 0.12, 0.45, 0.9))
    assert apart is not None
    assert (round(apart[0], 6), apart[1]) == (5.0, 2)
    assert apart_of(curve("tiles", 0.1)) is None


def test_numbers_are_written_as_people_read_them() -> None:
    assert (value_text(ROW), interval_text(ROW), verdict(ROW)) == ("0.500", "0.400 to 0.600", "")
    assert value_text(replace(ROW, value=12345, unit="bytes")) == "12,345 bytes"
    time = replace(ROW, value=1.25, unit=SECONDS, low=None, high=None)
    assert (value_text(time), interval_text(time)) == ("1.25 s", "")
    assert value_text(replace(ROW, value=None)) == "never"
    assert [verdict(replace(ROW, target=target)) for target in (0.5, 0.6)] == ["held", "missed"]


def test_both_documents_have_every_row_but_those_of_curves_and_nothing_from_elsewhere() -> None:
    figures = [replace(figure, svg="<svg></svg>") for figure in figures_of(EXPERIMENTS, ROWS)]
    sections = sections_of(EXPERIMENTS, ROWS, figures)
    page, text = (
        render(template, FACTS, sections, Gap(gap_of(ROWS), (3.21, 4)))
        for template in ("page.html.j2", "results.md.j2")
    )
    for document in (page, text):
        assert "differ by 2.0 points" in document
        assert "3.2 points apart, after update 4" in document
        assert "A lost message leaves the last one in place" in document
        assert "Size 5x4: holds nowhere, 0.50 at 0.1" in document
        assert "a curve" not in document
        assert "0.990 missed" in document
    assert page.count("<svg></svg>") == 2
    assert "&lt;tiles&gt;" in page
    assert "<tiles>" not in page
    assert AGAIN in page
    assert "http" not in page
    assert "![messages lost](images/results-edges-1.svg)" in text
