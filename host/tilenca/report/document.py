"""The report as text: one self-contained HTML page, and Markdown for docs/RESULTS.md."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jinja2
import markupsafe

from tilenca.report.atlas import HeatMap, endings, heat_maps
from tilenca.report.experiment import Experiment
from tilenca.report.experiments import CONVERGED, EDGES, INTRODUCTIONS, TITLES
from tilenca.report.field import field_of
from tilenca.report.rows import SHARE, Row
from tilenca.report.words import Mark, marks_of, why

POINTS = 100.0


@dataclass(frozen=True)
class Figure:
    """A figure.

    Attributes:
        section: one of `TITLES`.
        title: what it shows.
        axis: what it shows that along.
        rows: by the name of each line.
        key: of the experiment that is drawn, or of the first one.
        why: where the claim ends, and why, in words; empty where the section's introduction says it.
        ends: how far each line holds.
        marks: what others do there.
        maps: its heat maps; it has these, or a picture.
        svg: the picture; empty until it is drawn.
    """

    section: str
    title: str
    axis: str
    rows: Mapping[str, Sequence[Row]]
    key: str = ""
    why: str = ""
    ends: tuple[str, ...] = ()
    marks: tuple[Mark, ...] = ()
    maps: tuple[HeatMap, ...] = ()
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
    drawn: dict[str, list[Experiment]] = {}
    for experiment in experiments:
        if experiment.figure:
            drawn.setdefault(experiment.figure, []).append(experiment)
    return [
        _figure(title, mine[0], [row for one in mine for row in rows[one.key]])
        for title, mine in drawn.items()
    ]


def _figure(title: str, first: Experiment, rows: Sequence[Row]) -> Figure:
    about = first.section, title, first.axis
    if first.heat:
        return Figure(*about, {}, first.key, why(first.key), maps=tuple(heat_maps(rows)))
    lines: dict[str, list[Row]] = {}
    for row in rows:
        if row.across is not None:
            lines.setdefault(row.line, []).append(row)
    ordered = {name: sorted(mine, key=lambda row: row.across or 0) for name, mine in lines.items()}
    ends = tuple(endings(ordered)) if first.section == EDGES else ()
    return Figure(*about, ordered, first.key, why(first.key), ends, marks_of(first.key))


def apart_of(rows: Mapping[str, Sequence[Row]]) -> tuple[float, int] | None:
    """By how many points simulator and emulated tiles differ at most, update by update, and after which.

    The simulator has the times of the tiles. None: a report without these.
    """
    keys = [f"gap.{engine}.{CONVERGED}" for engine in ("timed", "tiles")]
    if not all(key in rows for key in keys):
        return None
    both = ([row for row in rows[key] if row.across is not None] for key in keys)
    apart = [
        (abs(one.value - other.value) * POINTS, int(one.across or 0))
        for one, other in zip(*both, strict=True)
        if one.value is not None and other.value is not None
    ]
    return max(apart)


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
                if experiment.section == section
                for row in rows[experiment.key]
                if not row.only_drawn
            ],
        }
        for section, title in TITLES.items()
    ]


def value_text(row: Row) -> str:
    """The number as people read it."""
    if row.value is None:
        return "never"
    if row.unit == SHARE:
        return f"{row.value:.3f}"
    number = f"{row.value:,}" if isinstance(row.value, int) else f"{row.value:g}"
    return f"{number} {row.unit}"


def interval_text(row: Row) -> str:
    """The interval; nothing where there is none."""
    return "" if row.low is None or row.high is None else f"{row.low:.3f} to {row.high:.3f}"


def verdict(row: Row) -> str:
    """Whether the target of a row was reached; nothing where it has none."""
    if row.target is None or row.value is None:
        return ""
    return "held" if row.value >= row.target else "missed"


def capitalise(text: str) -> str:
    """A text that begins a line: its first letter is a capital."""
    return text[:1].upper() + text[1:]


def short(title: str) -> str:
    """What a figure of the atlas varies: its title without what all of them show."""
    return title.rpartition(": ")[2]


def bold(text: str) -> str:
    """HTML of a text with `**bold**` parts, as markup; everything else in it is text."""
    parts = [markupsafe.escape(part) for part in text.split("**")]
    return markupsafe.Markup("").join(
        markupsafe.Markup("<strong>{}</strong>").format(part) if number % 2 else part
        for number, part in enumerate(parts)
    )


@dataclass(frozen=True)
class Gap:
    """How far simulator and emulated tiles are apart.

    Attributes:
        converged: see `gap_of`.
        by_update: see `apart_of`.
    """

    converged: float | None
    by_update: tuple[float, int] | None = None


def render(template: str, facts: Facts, sections: Sequence[Mapping[str, Any]], gap: Gap) -> str:
    """A document.

    Args:
        template: `page.html.j2` or `results.md.j2`.
        facts: of the report.
        sections: of `sections_of`.
        gap: between simulator and emulated tiles.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("tilenca.report"),
        autoescape=template.endswith(".html.j2"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "value": value_text,
        "interval": interval_text,
        "verdict": verdict,
        "bold": bold,
        "capitalise": capitalise,
        "short": short,
    }
    values = {row.key: value_text(row) for section in sections for row in section["rows"]}
    field = field_of(values, facts.quick)
    return environment.get_template(template).render(facts=facts, sections=sections, gap=gap, field=field)
