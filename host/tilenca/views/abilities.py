"""What a trained model can do and what it cannot, in words, from its measurements."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

# The keys of measurements (docs/TRAINING.md explains them), as a person asks.
QUESTIONS = {
    "drawings": "agree on every drawing",
    "convergence": "agree quickly",
    "varied": "know drawings by another hand",
    "sizes": "know other sizes",
    "lost": "stand lost messages",
    "damaged": "know drawings with a tile missing",
    "directions": "say where a tile is missing",
    "faults": "stand a tile that is off for a while",
    "dead": "stand many dead tiles",
    "unknown": "show a dash on drawings of no class",
    "one answer": "give one answer on any drawing",
    "changes": "follow when tiles are moved while they run",
    "longevity": "stay right for a long time",
}


def abilities(metrics: Mapping[str, Any]) -> Iterator[str]:
    """Up to three lines: what the model can do, what it cannot do well enough, what it was not trained for.

    Args:
        metrics: as in metrics.json.
    """
    rows = metrics["rows"]
    aimed = [row for row in rows if row["target"] is not None]
    asked = dict.fromkeys(row["key"] for row in aimed)
    missed = {row["key"] for row in aimed if not row["holds"]}
    others = dict.fromkeys(row["key"] for row in rows if row["key"] not in asked)
    can = [key for key in asked if key not in missed]
    for title, keys in (("can", can), ("not well enough", list(missed)), ("not trained to", list(others))):
        if keys:
            ordered = [key for key in QUESTIONS if key in keys]
            yield f"{title}: {', '.join(QUESTIONS[key] for key in ordered)}"


@dataclass(frozen=True)
class Targets:
    """Of one kind of measurement, as far as it has targets.

    Attributes:
        held, given: how many targets.
        least: the smallest of them.
        share: the smallest share of the runs in a row with a target.
    """

    held: int
    given: int
    least: float
    share: float


def targets_by_kind(metrics: Mapping[str, Any]) -> dict[str, Targets]:
    """The targets of each kind of measurement that has any; none where nothing was measured.

    Args:
        metrics: as in metrics.json.
    """
    kinds: dict[str, list[Mapping[str, Any]]] = {}
    for row in metrics.get("rows", []):
        if row["target"] is not None:
            kinds.setdefault(row["key"], []).append(row)
    return {
        kind: Targets(
            sum(row["holds"] for row in rows),
            len(rows),
            min(row["target"] for row in rows),
            min(row["share"] for row in rows),
        )
        for kind, rows in kinds.items()
    }
