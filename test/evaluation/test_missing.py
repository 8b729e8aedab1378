"""Where tiles say that one is missing: counted right for models of which we know what they say."""

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.base.sides import NORTH
from tilenca.evaluation.evaluator import Evaluator
from tilenca.evaluation.metrics import Measurement
from tilenca.evaluation.missing import BESIDE, BODIES, NONE, OTHERS, MissingCase, missing_cases
from tilenca.evaluation.suites import Aims, make_suite
from tilenca.model.directions import with_directions
from tilenca.model.file import Model, load_model
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.shapes.gaps import Gaps
from tilenca.shapes.sizes import Sizes
from tilenca.shapes.variant import LAST
from tilenca.simulator.engine import FastEngine

SILENT = with_directions(load_model(paths.DEFAULT_MODEL))


def saying(side: int) -> Model:
    """A model whose tiles always say that one is missing on this side."""
    integer = dict(SILENT.integer)
    integer["b3"] = integer["b3"].copy()
    channel = SILENT.dimensions.channels - len(SILENT.labels) - 4 + side
    integer["b3"][channel] = 20_000
    return Model(SILENT.labels, SILENT.dimensions, integer, SILENT.floats)


@pytest.fixture(scope="module")
def task() -> Drawings:
    return load_drawings([paths.DEFAULT_SHAPES], labels=SILENT.labels)


@pytest.fixture(scope="module")
def cases(task: Drawings) -> dict[str, MissingCase]:
    return {one.case.name: one for one in missing_cases(task, task.shapes, Gaps(task.shapes), (None,), LAST)}


def measured(model: Model, task: Drawings, runs: int = 1) -> dict[str, Measurement]:
    suite = make_suite(task, Sizes(), model.labels, Aims(directions=True), 1)
    return {row.name: row for row in Evaluator(FastEngine(model), suite, runs, 1).missing()}


def test_pairs_are_on_one_side_of_the_split_each(cases: dict[str, MissingCase]) -> None:
    used, new = (
        {shape.rows for shape in cases[f"5x4, where a tile is missing, {which}"].case.drawings.shapes}
        for which in ("pairs that training may use", "new pairs")
    )
    assert len(used) > len(new) > 0
    assert not used & new
    assert cases["5x4, where a tile is missing, new pairs"].case.held_out


def test_only_tiles_die_whose_absence_leaves_no_doubt(cases: dict[str, MissingCase], task: Drawings) -> None:
    dies = cases["5x4, a tile dies while they run"].dies
    assert dies is not None
    assert len(dies) >= len(Gaps(task.shapes).damaged(task.shapes))
    assert (dies[:, 1] < task.sizes[dies[:, 0]]).all()


def test_tiles_that_say_nothing_are_right_but_beside_a_gap(task: Drawings) -> None:
    rows = measured(SILENT, task)
    for name, row in rows.items():
        kind = name.rsplit(": ", 1)[1]
        assert row.share == {BESIDE: 0.0, OTHERS: 1.0, BODIES: 0.0, NONE: 1.0}[kind], name
        assert row.holds == (kind != BESIDE)


def test_tiles_that_always_say_north_are_right_where_the_gap_is_north(
    task: Drawings, cases: dict[str, MissingCase]
) -> None:
    rows, gaps = measured(saying(NORTH), task), Gaps(task.shapes)
    case = cases["5x4, where a tile is missing, pairs that training may use"].case
    sides = np.concatenate([gaps.sides(shape) for shape in case.drawings.shapes])
    row = rows[f"{case.name}: {BESIDE}"]
    assert row.share == pytest.approx(sides[:, NORTH].sum() / sides.sum(), abs=1e-4)
    assert row.runs == 2 * sides.sum(), "a run is a tile here, and every drawing has two"
    assert rows[f"{case.name}: {OTHERS}"].share == 0.0

    dying = cases["5x4, a tile dies while they run"]
    assert dying.dies is not None
    around = [task.shapes[number].neighbours()[tile] for number, tile in dying.dies]
    beside = [[side for side in range(4) if near[side] >= 0] for near in around]
    # The tile on the south of the dead one has it in its north.
    share = sum(2 in sides for sides in beside) / sum(map(len, beside))
    assert rows[f"{dying.case.name}: {BESIDE}"].share == pytest.approx(share, abs=1e-4)
    assert rows[f"{dying.case.name}, and is back: {NONE}"].share == 0.0


def test_a_row_by_itself_is_the_row_of_the_table(task: Drawings) -> None:
    suite = make_suite(task, Sizes(), SILENT.labels, Aims(directions=True), 1)
    name = f"5x4, whole: {NONE}"
    alone = list(Evaluator(FastEngine(SILENT), suite, 1, 1, [f"={name}"]).missing())
    assert [row.name for row in alone] == [name]
    assert alone[0] == measured(SILENT, task)[name]


def test_models_without_directions_are_not_asked(task: Drawings) -> None:
    assert make_suite(task, Sizes(), SILENT.labels, Aims(), 1).missing == ()
