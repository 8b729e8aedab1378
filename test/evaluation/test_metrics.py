"""What a model is worth: the rows of the table, their targets, and tissues rebuilt while running."""

import json
from dataclasses import replace

import numpy as np
import pytest

from support.measurements import row
from tilenca.base import paths
from tilenca.evaluation.card import render_card
from tilenca.evaluation.cases import Case
from tilenca.evaluation.metrics import Runs, Target, least_shares, measure, median_interval, wilson
from tilenca.evaluation.suites import Aims, make_suite
from tilenca.evaluation.validation import validate
from tilenca.model.file import Model, load_model
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import Shape
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import MIXED, Trajectory


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model(paths.DEFAULT_MODEL)


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


def test_the_smallest_share_of_a_kind_is_that_of_its_rows_with_a_target() -> None:
    aim = Target(0.9)
    rows = [row(0.1), row(0.95, aim), row(0.92, aim), row(0.2)]
    assert least_shares(rows) == {"drawings": 0.92}
    assert least_shares([row(0.3), row(0.2)]) == {"drawings": 0.2}, "without a target all of them count"


def test_the_same_seed_measures_the_same_and_the_card_shows_it(model: Model) -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 1.5, 20)
    suite = make_suite(replace(task, labels=model.labels), sizes, model.labels, Aims(1.5, True, True), 1)
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


def test_a_run_that_is_not_right_is_dash_wrong_or_split() -> None:
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 1.0, 20)
    drawings = replace(task, labels=(*task.labels, "-")).chosen([0, 1])
    dash = 10
    chosen = np.array([0, 0, 0, 0, 1, 1, 1, 1])
    answers = np.array([0, 1, dash, MIXED, 1, 1, dash, 0])
    trajectory = Trajectory((answers == drawings.classes[chosen]).astype(np.float32)[None])
    runs = Runs(Case("drawn", "some", drawings, 1), chosen, trajectory, {1: answers})
    found = measure("drawings", "some", runs, 1, None)
    assert (found.share, found.dash, found.wrong, found.split) == (3 / 8, 2 / 8, 2 / 8, 1 / 8)
    assert "dash 0.2500, wrong 0.2500, split 0.1250" in found.text()
    told = measure("drawings", "some", replace(runs, answers={}), 1, None)
    assert (told.dash, told.wrong, told.split) == (None, None, None)
    assert "split" not in told.text()
    nothing = replace(drawings, labels=task.labels)
    without = measure("drawings", "some", replace(runs, case=replace(runs.case, drawings=nothing)), 1, None)
    assert without.dash == 0, "a model without a dash never shows one"


def test_where_the_dash_is_right_it_is_not_a_miss() -> None:
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 1.0, 20)
    none = replace(task, labels=(*task.labels, "-")).of([Shape("-", ("##",), "none")])
    answers = np.array([10, 10, 3, MIXED])
    runs = Runs(
        Case("unknown", "none", none, 1),
        np.zeros(4, np.int64),
        Trajectory((answers == 10).astype(np.float32)[None]),
        {1: answers},
    )
    found = measure("unknown", "none", runs, 1, None)
    assert (found.share, found.dash, found.wrong, found.split) == (0.5, 0, 0.25, 0.25)


def test_the_interval_of_a_median_is_between_order_statistics_and_may_have_no_upper_end() -> None:
    hundred = np.arange(1.0, 101.0)
    low, high = median_interval(hundred)
    assert (low, high) == (40.0, 61.0)  # the 40th and the 61st of 100 (Conover, 1999)
    assert median_interval(np.array([1.0, 2.0, np.inf])) == (1.0, np.inf)
    assert median_interval(np.array([3.0])) == (3.0, 3.0)
