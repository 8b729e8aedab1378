"""What a model is worth: the rows of the table, their targets, and tissues rebuilt while running."""

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.evaluation.card import render_card
from tilenca.evaluation.metrics import Measurement, Target, validate, wilson
from tilenca.evaluation.suites import Aims, make_suite
from tilenca.model.file import Model, load_model
from tilenca.shapes.batch import Drawings, load_drawings, load_training_task
from tilenca.shapes.cells import connected
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.transitions import rebuild, rebuild_tile_by_tile
from tilenca.training.results import Result, history_csv, keep


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model(paths.DEFAULT_MODEL)


@pytest.fixture(scope="module")
def digits(model: Model) -> Drawings:
    return load_drawings([paths.DEFAULT_SHAPES], labels=model.labels)


def row(share: float, target: Target | None = None, worst: float | None = None) -> Measurement:
    settle = {"median": 7.0, "p95": None}
    aim = (None, 0.0) if target is None else (target.share, target.floor)
    return Measurement(
        "drawings",
        "some",
        60,
        1,
        100,
        share,
        0.0,
        1.0,
        ("4", share if worst is None else worst),
        settle,
        *aim,
    )


def test_the_interval_of_a_share_is_wilsons() -> None:
    # Brown, Cai and DasGupta (2001), table of exact values for n = 50.
    low, high = wilson(0, 50)
    assert low == 0
    assert high == pytest.approx(0.0713, abs=5e-4)
    assert wilson(50, 50) == pytest.approx((1 - high, 1), abs=1e-9)
    assert wilson(25, 50) == pytest.approx((0.3664, 0.6336), abs=5e-4)


def test_a_row_holds_when_its_share_and_its_worst_drawing_reach_the_target() -> None:
    assert row(0.9).holds, "without a target nothing is missed"
    assert row(0.99, Target(0.98)).holds
    assert not row(0.97, Target(0.98)).holds
    assert row(0.99, Target(0.98, 0.9), worst=0.95).holds
    missed = row(0.99, Target(0.98, 0.9), worst=0.8)
    assert not missed.holds
    assert missed.shortfall == pytest.approx(0.1)
    assert missed.as_json()["holds"] is False


@pytest.mark.parametrize("change", [rebuild, rebuild_tile_by_tile], ids=["at once", "tile by tile"])
def test_running_tiles_rebuilt_into_another_digit_name_it(
    change: object, model: Model, digits: Drawings
) -> None:
    assert callable(change)
    changed = change(FastEngine(model), digits, 1, 60, 60, np.random.default_rng(1))
    assert changed is not None
    trajectory, new = changed
    assert len(new) == 90
    assert (np.bincount(new) == 9).all()
    assert trajectory.agreed[-1].mean() > 0.95


def test_one_class_alone_has_nothing_to_be_rebuilt_into(model: Model, digits: Drawings) -> None:
    assert rebuild(FastEngine(model), digits.chosen([4]), 1, 5, 5, np.random.default_rng(1)) is None
    assert (
        rebuild_tile_by_tile(FastEngine(model), digits.chosen([4]), 1, 5, 5, np.random.default_rng(1)) is None
    )


def test_on_the_way_from_one_drawing_to_another_tiles_hang_together(digits: Drawings) -> None:
    from tilenca.simulator.transitions import _walk

    random = np.random.default_rng(3)
    for old in range(10):
        for new in range(10):
            steps = list(_walk(digits, old, new, random))
            assert set(steps[0]) == set(digits.shapes[old].cells)
            assert len(steps[-1]) == len(digits.shapes[new].cells)
            for before, after in pairwise(steps):
                assert len(set(before) ^ set(after)) == 1
                assert connected(after)


def test_the_same_seed_measures_the_same_and_the_card_shows_it(model: Model) -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    suite = make_suite(replace(task, labels=model.labels), sizes, model.labels, Aims(10, True, True), 1)
    said: list[str] = []
    metrics = validate(FastEngine(model), suite, 2, 1, said.append)
    assert metrics == validate(FastEngine(model), suite, 2, 1)
    assert metrics == json.loads(json.dumps(metrics))
    assert len(said) == len(metrics["rows"])
    assert all(0 <= row["low"] <= row["share"] <= row["high"] <= 1 for row in metrics["rows"])
    model = replace(model, metadata={"shapes": ["shapes/digits.toml"], **model.metadata})
    card = render_card(
        model, {**metrics, "weights_cut": 0, "iterations": 10, "best_iteration": 8, "ended_early": True}
    )
    for line in metrics["rows"]:
        assert line["name"] in card
    assert model.metadata["command"] in card
    assert "since all targets held" in card


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
