"""The evaluator measures every case of a suite, on the shipped model."""

from dataclasses import replace

import pytest

from tilenca.base import paths
from tilenca.evaluation.evaluator import CONVERGED_BY, DEAD, FAULTS, Evaluator
from tilenca.evaluation.suites import Suite, make_suite
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_training_task
from tilenca.simulator.engine import FastEngine
from tilenca.training.recipe import aims_of
from tilenca.training.recipes import RECIPES

MODEL = load_model(paths.DEFAULT_MODEL)


@pytest.fixture(scope="module")
def suite() -> Suite:
    recipe = replace(RECIPES["full"], stretch=1.5)
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], recipe.stretch, 20)
    return make_suite(replace(task, labels=MODEL.labels), sizes, MODEL.labels, aims_of(recipe), 1)


def test_short_measurements_run_on_the_clocks_only_and_change_everything_at_once(suite: Suite) -> None:
    suite = replace(
        suite, sizes=suite.sizes[:1], unknown=suite.unknown[:1], damaged=suite.damaged[:1], larger=()
    )
    measured = [
        list(rows(Evaluator(FastEngine(MODEL), suite, 1, 1)))
        for rows in (Evaluator.short_rows, Evaluator.rows)
    ]
    targets = [{(row.name, row.steps): (row.target, row.floor) for row in rows} for rows in measured]
    assert targets[0].items() <= targets[1].items(), "training and the last measurement have one aim"
    short, full = ([row.name for row in rows] for rows in measured)
    left_out = [name for name in full if name not in short]
    assert {name.split(", ")[-1] for name in left_out} == {
        "the paper's listing",
        "two random halves a step",
        "a tile every 1 update",
        "a tile every 15 updates",
        "a tile every 40 updates",
    }
    assert [name for name in full if name in short] == short


def test_steps_of_a_fault_count_from_its_last_change(suite: Suite) -> None:
    rows = [row for row in Evaluator(FastEngine(MODEL), suite, 3, 1).disturbed() if row.key == "faults"]
    assert [row.name for row in rows] == [name for name, *_ in FAULTS]
    for row in rows:
        assert row.steps == CONVERGED_BY
        assert row.runs == 3 * row.drawings
    assert rows[-1].share > 0.9, "of these only a tile that was away is there again"
    assert [row.best is not None for row in rows] == [name == DEAD for name, *_ in FAULTS]
    assert rows[0].best is not None
    assert rows[0].low < rows[0].best < 1


def test_every_row_about_one_moment_says_what_the_other_runs_show(suite: Suite) -> None:
    rows = list(Evaluator(FastEngine(MODEL), replace(suite, sizes=()), 3, 1).rows())
    told = [row for row in rows if row.split is not None]
    assert {row.key for row in rows if row.split is None} == {"convergence", "longevity"}
    for row in told:
        assert row.dash is not None
        assert row.wrong is not None
        assert row.split is not None
        assert row.share + row.dash + row.wrong + row.split == pytest.approx(1, abs=2e-5), row.name
    assert {row.key for row in told} > {"drawings", "varied", "sizes", "lost", "damaged", "faults", "unknown"}
    early = [row.split for row in told if row.steps == 10 and row.split is not None]
    assert max(early) > 0, "after ten steps of the listing some runs are not of one mind yet"


def test_a_row_by_itself_is_the_row_of_the_table(suite: Suite) -> None:
    suite = replace(suite, sizes=suite.sizes[:2], damaged=suite.damaged[:2], unknown=suite.unknown[:1])
    engine = FastEngine(MODEL)
    every = list(Evaluator(engine, suite, 2, 7).rows())
    for row in every[:: max(1, len(every) // 12)]:
        alone = list(Evaluator(engine, suite, 2, 7, [row.name]).rows())
        assert row in alone
        assert {other.name for other in alone} <= {other.name for other in every if row.name in other.name}
        exact = Evaluator(engine, suite, 2, 7, [f"={row.name}"]).rows()
        assert {other.name for other in exact} == {row.name}
    assert not list(Evaluator(engine, suite, 2, 7, ["no such row"]).rows())
