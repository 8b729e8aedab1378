"""The model card of the shipped digits, from what is stored beside them."""

import json
from typing import Any

import pytest

from tilenca.base import paths
from tilenca.base.shipped import model_names
from tilenca.evaluation.card import render_card
from tilenca.evaluation.suites import recorded_aims
from tilenca.model.file import Model, load_model


@pytest.fixture
def model() -> Model:
    return load_model(paths.DEFAULT_MODEL)


@pytest.fixture
def metrics() -> dict[str, Any]:
    stored: dict[str, Any] = json.loads((paths.DEFAULT_MODEL / "metrics.json").read_text(encoding="utf-8"))
    return stored


def test_every_row_of_the_metrics_is_one_of_the_table(model: Model, metrics: dict[str, Any]) -> None:
    table = [line for line in render_card(model, metrics).splitlines() if line.startswith("| ")]
    assert len(table) == len(metrics["rows"]) + 1
    for row, line in zip(metrics["rows"], table[1:], strict=True):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        assert cells[:4] == [row["name"], str(row["steps"]), str(row["drawings"]), str(row["runs"])]
        assert float(cells[4]) == pytest.approx(row["share"], abs=5e-5)
        assert (cells[11].endswith("held") or "missed" in cells[11]) == (row["target"] is not None)


def test_what_the_other_runs_show_and_what_is_possible_at_best_stand_beside_a_row(
    model: Model, metrics: dict[str, Any]
) -> None:
    shares = {"dash": 0.25, "wrong": 0.125, "split": 0.0625, "target": None, "best": 0.61237}
    row = {**metrics["rows"][0], **shares}
    [_, line] = [
        line for line in render_card(model, {**metrics, "rows": [row]}).splitlines() if line.startswith("| ")
    ]
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    assert cells[6:9] == ["0.2500", "0.1250", "0.0625"]
    assert cells[11] == "at best 0.612"


def test_it_says_how_to_make_the_model_again(model: Model, metrics: dict[str, Any]) -> None:
    card = render_card(model, metrics)
    assert card.startswith(f"# Model {model.model_id:04X}: {' '.join(model.labels)}\n")
    assert f"    {model.metadata['command']}\n" in card
    assert f"--seed {metrics['seed']}\n" in card
    assert card.endswith("\n")
    assert "\n\n\n" not in card


def test_a_target_that_was_missed_stands_out(model: Model, metrics: dict[str, Any]) -> None:
    row = {**metrics["rows"][0], "target": 1.0, "holds": False, "convergence": {"median": 5.0, "p95": None}}
    [_, line] = [
        line for line in render_card(model, {**metrics, "rows": [row]}).splitlines() if line.startswith("| ")
    ]
    assert "1.000 **missed**" in line
    assert "5, never" in line


def test_a_run_that_ended_early_and_weights_that_were_cut_are_told(
    model: Model, metrics: dict[str, Any]
) -> None:
    changed = {**metrics, "ended_early": True, "iterations": 700, "best_iteration": 600, "weights_cut": 3}
    card = render_card(model, changed)
    assert "ended after 700 of" in card
    assert "of iteration 600" in card
    assert card.endswith("3 weights lay outside the integer range and were cut to it.\n")
    plain = render_card(model, {**changed, "ended_early": False, "best_iteration": 700, "weights_cut": 0})
    assert "since all targets held" not in plain
    assert "of iteration" not in plain
    assert "were cut" not in plain


@pytest.mark.parametrize("name", model_names())
def test_the_cards_of_all_models_have_the_targets_of_their_recipes(name: str) -> None:
    folder = paths.MODELS / name
    model, metrics = load_model(folder), json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    assert (folder / "README.md").read_text(encoding="utf-8") == render_card(model, metrics)
    aimed = [row for row in metrics["rows"] if row["target"] is not None]
    assert metrics["targets_held"] == f"{sum(row['holds'] for row in aimed)} of {len(aimed)}"
    asked = {row["target"] is not None for row in metrics["rows"] if row["key"] == "one answer"}
    assert asked == {recorded_aims(model).agreeing}
