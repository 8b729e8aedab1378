"""What a model can do, in words."""

import json

from tilenca.base import paths
from tilenca.views.abilities import QUESTIONS, Targets, abilities, targets_by_kind


def row(key: str, holds: bool, target: float | None = 0.9, share: float = 0.95) -> dict[str, object]:
    return {"key": key, "holds": holds, "target": target, "share": share}


def test_a_kind_with_one_missed_target_is_not_done_well_enough() -> None:
    rows = [row("drawings", True), row("sizes", True), row("sizes", False), row("unknown", False, None)]
    assert list(abilities({"rows": rows})) == [
        "can: agree on every drawing",
        "not well enough: know other sizes",
        "not trained to: show a dash on drawings of no class",
    ]
    assert list(abilities({"rows": rows[:2]})) == ["can: agree on every drawing, know other sizes"]


def test_every_kind_of_every_shipped_model_has_words() -> None:
    for metrics in sorted(paths.MODELS.glob("*/metrics.json")):
        document = json.loads(metrics.read_text(encoding="utf-8"))
        assert {one["key"] for one in document["rows"]} <= QUESTIONS.keys(), metrics
        assert next(iter(abilities(document))).startswith(("can: ", "not well enough: "))


def test_targets_are_counted_by_kind() -> None:
    rows = [row("sizes", True), row("sizes", False, 0.5, 0.4), row("drawings", True)]
    rows.append(row("unknown", True, None, 0.1))
    assert targets_by_kind({"rows": rows}) == {
        "sizes": Targets(1, 2, 0.5, 0.4),
        "drawings": Targets(1, 1, 0.9, 0.95),
    }
