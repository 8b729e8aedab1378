"""The report as text: one self-contained HTML page, and Markdown for docs/RESULTS.md."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jinja2
import markupsafe

from tilenca.report.experiments import CONVERGED, INTRODUCTIONS, TITLES, Experiment
from tilenca.report.field import field_of
from tilenca.report.rows import SHARE, Row

POINTS = 100.0


@dataclass(frozen=True)
class Figure:
    """A figure.

    Attributes:
        section: one of `TITLES`.
        title: what it shows.
        axis: what it shows that along.
        rows: by the name of each line.
        svg: the picture; empty until it is drawn.
    """

    section: str
    title: str
    axis: str
    rows: Mapping[str, Sequence[Row]]
    svg: str = ""


@dataclass(frozen=True)
class Facts:
    """What a reader wants to know of a report as a whole.

    Attributes:
        command: that makes it.
        version: of tilenca.
        model: id of the shipped model.
        date: of the measurements.
        machine: where.
        quick: whether it is the quick one.
    """

    command: str
    version: str
    model: str
    date: str
    machine: str
    quick: bool


def figures_of(experiments: Sequence[Experiment], rows: Mapping[str, Sequence[Row]]) -> list[Figure]:
    """The figures: the rows along an axis of experiments with the same figure."""
    first: dict[str, Experiment] = {}
    lines: dict[str, dict[str, list[Row]]] = {}
    for experiment in experiments:
        if experiment.figure:
            first.setdefault(experiment.figure, experiment)
            for row in rows[experiment.key]:
                lines.setdefault(experiment.figure, {}).setdefault(row.line, []).append(row)
    return [
        Figure(
            first[title].section,
            title,
            first[title].axis,
            {name: sorted(mine, key=lambda row: row.across or 0) for name, mine in of_title.items()},
        )
        for title, of_title in lines.items()
    ]


def gap_of(rows: Mapping[str, Sequence[Row]]) -> float | None:
    """By how many points all tiles right differs at most between simulator and emulated tiles that agree."""
    of_tiles = [key for key in rows if key.startswith(f"gap.tiles.{CONVERGED}")]
    pairs = [(rows[key][0].value, rows[key.replace(".tiles.", ".fast.")][0].value) for key in of_tiles]
    differences = [abs(one - other) for one, other in pairs if one is not None and other is not None]
    return max(differences) * POINTS if differences else None


def sections_of(
    experiments: Sequence[Experiment], rows: Mapping[str, Sequence[Row]], figures: Sequence[Figure]
) -> list[dict[str, Any]]:
    """The sections of both documents, in order: title, introduction, figures and rows."""
    return [
        {
            "key": section,
            "title": title,
            "introduction": INTRODUCTIONS[section],
            "figures": [figure for figure in figures if figure.section == section],
            "rows": [
                row
                for experiment in experiments
                if experiment.section == section and experiment.reader != "curve"
                for row in rows[experiment.key]
            ],
        }
        for section, title in TITLES.items()
    ]


def value_text(row: Row) -> str:
    """The number as people read it."""
    if row.value is None:
        return "never"
    return f"{row.value:.3f}" if row.unit == SHARE else f"{row.value:g} {row.unit}"


def interval_text(row: Row) -> str:
    """The interval; nothing where there is none."""
    return "" if row.low is None or row.high is None else f"{row.low:.3f} to {row.high:.3f}"


def verdict(row: Row) -> str:
    """Whether the target of a row was reached; nothing where it has none."""
    if row.target is None or row.value is None:
        return ""
    return "held" if row.value >= row.target else "missed"


def bold(text: str) -> str:
    """HTML of a text with `**bold**` parts, as markup; everything else in it is text."""
    parts = [markupsafe.escape(part) for part in text.split("**")]
    return markupsafe.Markup("").join(
        markupsafe.Markup("<strong>{}</strong>").format(part) if number % 2 else part
        for number, part in enumerate(parts)
    )


def render(template: str, facts: Facts, sections: Sequence[Mapping[str, Any]], gap: float | None) -> str:
    """A document.

    Args:
        template: `page.html.j2` or `results.md.j2`.
        facts: of the report.
        sections: of `sections_of`.
        gap: of `gap_of`.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("tilenca.report"),
        autoescape=template.endswith(".html.j2"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"value": value_text, "interval": interval_text, "verdict": verdict, "bold": bold}
    values = {row.key: value_text(row) for section in sections for row in section["rows"]}
    field = field_of(values, facts.quick)
    return environment.get_template(template).render(facts=facts, sections=sections, gap=gap, field=field)
