"""The table of a model as plain values."""

from tilenca.base import paths
from tilenca.evaluation.cases import SHORT_STEPS, Case
from tilenca.evaluation.suites import Suite
from tilenca.evaluation.validation import validate
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings
from tilenca.simulator.engine import FastEngine

MODEL = load_model(paths.DEFAULT_MODEL)


def test_every_row_is_told_as_soon_as_it_is_measured() -> None:
    drawings = load_drawings([paths.DEFAULT_SHAPES], labels=MODEL.labels)
    only_drawn = Suite((Case("drawn", "digits.toml", drawings, SHORT_STEPS),), (), (), (), ())
    said: list[str] = []
    metrics = validate(FastEngine(MODEL), only_drawn, 1, 1, said.append)
    assert [line.split(", @")[0] for line in said] == [row["name"] for row in metrics["rows"]]
    aimed = [row for row in metrics["rows"] if row["target"] is not None]
    assert metrics["targets_held"] == f"{sum(row['holds'] for row in aimed)} of {len(aimed)}"
    some = validate(FastEngine(MODEL), only_drawn, 1, 1, only=["converged"])
    assert some["rows"] == [row for row in metrics["rows"] if "converged" in row["name"]]
