"""Bodies as a whole: any connected drawing, one tile too many, dead tiles."""

import numpy as np

from tilenca.base import paths
from tilenca.evaluation.bodies import agreeing_cases, dead_cases
from tilenca.evaluation.evaluator import Evaluator
from tilenca.evaluation.metrics import Measurement
from tilenca.evaluation.suites import Aims, make_suite
from tilenca.model.file import load_model
from tilenca.shapes.batch import UNLABELLED, load_training_task
from tilenca.shapes.cells import cells_of, connected
from tilenca.simulator.engine import FastEngine

TASK, SIZES = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
FIRST = TASK.group(0)
MODEL = load_model(paths.MODELS / "digits")


def test_every_drawing_that_must_agree_is_connected_and_the_same_seed_draws_the_same() -> None:
    cases = list(agreeing_cases(TASK, FIRST, SIZES, seed=3, asked=True))
    assert [(case.name.split(",")[0], case.steps) for case in cases] == [("5x4", 60)] * 2 + [
        ("12x10", 100)
    ] * 2
    for case in cases:
        assert len(case.drawings) >= 50
        assert all(connected(cells_of(shape.rows)) for shape in case.drawings.shapes)
    any_drawing, more = cases[:2]
    assert {shape.label for shape in any_drawing.drawings.shapes} == {UNLABELLED}
    drawn = {shape.label: len(shape.cells) for shape in FIRST}
    assert all(len(shape.cells) == drawn[shape.label] + 1 for shape in more.drawings.shapes)
    again = next(agreeing_cases(TASK, FIRST, SIZES, seed=3, asked=True))
    assert again.drawings.shapes == any_drawing.drawings.shapes


def test_dead_tiles_are_asked_for_strokes_one_and_two_tiles_thick() -> None:
    cases = list(dead_cases(TASK, FIRST, SIZES, damaged=True, varied=False))
    assert [(case.dead, case.aimed) for case in cases] == [
        (0.05, True),
        (0.15, True),
        (0.05, False),
        (0.15, False),
    ]
    thin, thick = cases[0].drawings, cases[2].drawings
    assert thin.largest == thick.largest == (10, 8)
    assert [len(shape.cells) for shape in thick.shapes] == [4 * len(shape.cells) for shape in FIRST]


def rows_of(part: str) -> dict[str, Measurement]:
    suite = make_suite(TASK, SIZES, MODEL.labels, Aims(10.0, damaged=True, unknown=True), seed=1)
    evaluator = Evaluator(FastEngine(MODEL), suite, 10, seed=1)
    return {row.name: row for row in getattr(evaluator, part)()}


def test_a_row_of_one_answer_counts_all_runs_that_are_not_split() -> None:
    rows = rows_of("agreeing")
    for name, row in rows.items():
        assert row.split is not None
        if "any connected" in name:
            assert np.isclose(row.share, 1 - row.split, atol=3e-5)
        else:
            assert row.wrong is not None
            assert np.isclose(row.share, 1 - row.split - row.wrong, atol=3e-5)
    assert rows["5x4, any connected drawing: one answer on all tiles"].share > 0.5


def test_dead_tiles_of_thin_strokes_are_measured_against_the_best_guess() -> None:
    rows = list(rows_of("dead").values())
    assert len(rows) == 4
    for row in rows[:2]:
        assert row.best is not None
        assert row.target is not None
        assert row.share < row.best < 1
        assert np.isclose(row.target, row.best - 0.03)
    assert rows[0].best > rows[1].best  # type: ignore[operator]
    assert [row.best for row in rows[2:]] == [None, None]
