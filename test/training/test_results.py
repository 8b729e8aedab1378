"""What is kept of a training: never a worse model than the one that is there."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from support.measurements import row
from tilenca.base import paths
from tilenca.evaluation.metrics import Target
from tilenca.model.file import Model, load_model
from tilenca.training.results import Result, history_csv, keep


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model(paths.DEFAULT_MODEL)


def a_result(model: Model, shortfall: float) -> Result:
    rows = [row(1 - shortfall, Target(1.0)).as_json()]
    metrics = {
        "runs_per_drawing": 1,
        "seed": 1,
        "rows": rows,
        "targets_held": "0 of 1",
        "shortfall": shortfall,
    }
    metrics |= {"weights_cut": 0, "iterations": 1, "best_iteration": 1, "ended_early": False}
    model = replace(model, metadata={"shapes": ["shapes/digits.toml"], **model.metadata})
    return Result(
        model,
        metrics,
        [(20, 0.5, 0.25), (40, 0.25, 0.5)],
        [(30, 0.2, {"drawings": 0.8}), (40, 0.1, {"drawings": 0.9})],
    )


def test_a_worse_model_does_not_replace_a_better_one(
    model: Model, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert keep(tmp_path, a_result(model, 0.1)) == tmp_path
    better = (tmp_path / "metrics.json").read_bytes()
    worse = keep(tmp_path, a_result(model, 0.2))
    assert worse == tmp_path / f"model-{model.model_id:04X}"
    assert load_model(worse).model_id == model.model_id
    assert (tmp_path / "metrics.json").read_bytes() == better
    assert "holds the better model" in capsys.readouterr().err
    assert keep(tmp_path, a_result(model, 0.05)) == tmp_path
    assert json.loads((tmp_path / "metrics.json").read_text())["shortfall"] == 0.05


def test_a_model_of_other_drawings_is_replaced_whatever_it_scored(model: Model, tmp_path: Path) -> None:
    keep(tmp_path, a_result(model, 0.1))
    others = replace(model, metadata={**model.metadata, "sources": [{"file": "other.toml", "sha256": ""}]})
    assert keep(tmp_path, a_result(others, 0.2)) == tmp_path


def test_damaged_metrics_of_an_old_model_are_no_reason_to_keep_it(model: Model, tmp_path: Path) -> None:
    (tmp_path / "metrics.json").write_text('{"rows": [3]}')
    assert keep(tmp_path, a_result(model, 0.2)) == tmp_path


def test_the_history_has_a_column_for_every_kind_of_measurement(model: Model) -> None:
    assert history_csv(a_result(model, 0.1)).splitlines() == [
        "iteration,loss,agreement,@drawings",
        "20,0.50000,0.25000,",
        "30,,,0.80000",
        "40,0.25000,0.50000,0.90000",
    ]
