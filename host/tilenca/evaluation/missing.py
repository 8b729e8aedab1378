"""Whether tiles say where one is missing: from the start, after one died, and when all are there.

These rows count tiles, not only runs: those beside the gap, which should say the side where it is, and the
others, which should say nothing; and the bodies of which every tile says the right thing.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.cases import SHORT_STEPS, Case, steps_for
from tilenca.evaluation.metrics import Measurement, Runs, Target, measure, target_of
from tilenca.model.directions import NOWHERE, missing_sides
from tilenca.shapes.batch import Batch, Drawings
from tilenca.shapes.derive import at_size
from tilenca.shapes.edits import rows_of
from tilenca.shapes.file import Shape
from tilenca.shapes.gaps import Gaps
from tilenca.shapes.sizes import Size, size_name
from tilenca.shapes.variant import TRAINED, split_of
from tilenca.simulator.conditions import Conditions, Fault
from tilenca.simulator.engine import Engine
from tilenca.simulator.simulator import Simulator, Trajectory

# Kinds of rows; the first two count tiles, the others bodies.
BESIDE, OTHERS = "the tiles beside the gap say where", "the other tiles say nothing"
BODIES, NONE = "all tiles say the right thing", "no tile says that one is missing"
SETTLED = 60  # steps before a tile dies
Chance = Callable[[str], np.random.Generator]


@dataclass(frozen=True)
class MissingCase:
    """Drawings to ask where a tile is missing.

    Attributes:
        case: the drawings, damaged or whole.
        gaps: knows where.
        dies: (K, 2) int64, drawings of the case, and the tile that dies while they run; None: no tile dies.
    """

    case: Case
    gaps: Gaps
    dies: NDArray[np.int64] | None = None

    @property
    def rows(self) -> dict[str, str]:
        """The names of its rows, by their kind."""
        name = self.case.name
        if self.dies is not None:
            asked = {kind: f"{name}: {kind}" for kind in (BESIDE, OTHERS, BODIES)}
            return asked | {NONE: f"{name}, and is back: {NONE}"}
        kinds = (NONE,) if self.case.kind == "whole" else (BESIDE, OTHERS, BODIES)
        return {kind: f"{name}: {kind}" for kind in kinds}


def missing_cases(
    task: Drawings, first: Sequence[Shape], gaps: Gaps, sizes: Sequence[Size | None], split: str
) -> Iterator[MissingCase]:
    """Whole drawings, with one tile missing, and with one that dies.

    Args:
        task: of the model.
        first: the drawings of the first file.
        gaps: of all whole drawings.
        sizes: at which to ask; None: as drawn.
        split: the side of the split of the new pairs.
    """
    for size in sizes:
        shapes = list(first) if size is None else at_size(first, size)
        name, steps = size_name(size or task.largest), SHORT_STEPS if size is None else steps_for(size)
        less = gaps.damaged(shapes)
        for which, pairs in ((TRAINED, "pairs that training may use"), (split, "new pairs")):
            if some := [shape for shape in less if split_of(shape.rows) == which]:
                label = f"{name}, where a tile is missing, {pairs}"
                yield MissingCase(Case("missing", label, task.of(some), steps, which == split), gaps)
        if dies := [(number, tile) for number, shape in enumerate(shapes) for tile in _told(shape, gaps)]:
            case = Case("dies", f"{name}, a tile dies while they run", task.of(shapes), steps)
            yield MissingCase(case, gaps, np.array(dies))
        yield MissingCase(Case("whole", f"{name}, whole", task.of(shapes), steps), gaps)


def _told(shape: Shape, gaps: Gaps) -> Iterator[int]:
    """The tiles of a whole drawing whose absence leaves no doubt."""
    for tile in range(len(shape.cells)) if len(shape.cells) > 1 else ():
        rest = Shape(shape.label, rows_of(shape.cells[:tile] + shape.cells[tile + 1 :]), shape.name)
        found = gaps.missing(rest)
        if found is not None and found[0] == shape.rows:
            yield tile


def missing_rows(engine: Engine, asked: MissingCase, runs: int, chance: Chance) -> Iterator[Measurement]:
    """The rows of a case.

    Args:
        engine: the model's, which has directions.
        asked: the case.
        runs: as many runs of ten drawings, shared by all drawings of the case.
        chance: of a row, by its name.
    """
    case, names = asked.case, asked.rows
    classes, random = len(case.drawings.labels), chance(case.name)
    if asked.dies is None:
        each = max(2, 10 * runs // len(case.drawings))
        chosen = np.repeat(np.arange(len(case.drawings)), each)
        simulator = Simulator(engine, case.drawings, chosen, Conditions("clock"), random)
        simulator.run(case.steps)
        wanted = _wanted(case.drawings, chosen, asked.gaps)
        yield from _rows(case, names, simulator, chosen, wanted, missing_sides(simulator.states, classes))
        return
    chosen, tiles = np.repeat(asked.dies, max(1, 10 * runs // len(asked.dies)), axis=0).T
    fault = Fault("away", tiles, SETTLED, SETTLED + case.steps)
    simulator = Simulator(engine, case.drawings, chosen, Conditions("clock", fault=fault), random)
    gone = simulator.batch.starts + tiles
    simulator.run(SETTLED + case.steps)
    beside = simulator.batch.neighbours == gone[simulator.batch.sample][:, None]
    wanted = np.where(beside.any(axis=1), beside.argmax(axis=1), NOWHERE)
    there = np.ones(simulator.cells, np.bool_)
    there[gone] = False
    says = missing_sides(simulator.states, classes)
    dying = {kind: names[kind] for kind in (BESIDE, OTHERS, BODIES)}
    yield from _rows(case, dying, simulator, chosen, wanted, says, there)
    simulator.run(case.steps)
    nothing = np.full(simulator.cells, NOWHERE)
    back = {NONE: names[NONE]}
    yield from _rows(case, back, simulator, chosen, nothing, missing_sides(simulator.states, classes))


def _wanted(drawings: Drawings, chosen: NDArray[np.int64], gaps: Gaps) -> NDArray[np.int64]:
    """(N,) the side that each tile of these runs should say."""
    sides = [gaps.sides(shape) for shape in drawings.shapes]
    each = [
        np.full(len(shape.cells), NOWHERE)
        if one is None
        else np.where(one.any(axis=1), one.argmax(axis=1), NOWHERE)
        for shape, one in zip(drawings.shapes, sides, strict=True)
    ]
    return np.concatenate([each[number] for number in chosen])


def _rows(
    case: Case,
    names: dict[str, str],
    runs: Simulator,
    chosen: NDArray[np.int64],
    wanted: NDArray[np.int64],
    says: NDArray[np.int64],
    there: NDArray[np.bool_] | None = None,
) -> Iterator[Measurement]:
    """The rows of one moment: shares of tiles that are there, and of bodies of which all tiles are right."""
    batch: Batch = runs.batch
    there = np.ones(len(says), np.bool_) if there is None else there
    right = (says == wanted) | ~there
    bodies = np.logical_and.reduceat(right, batch.starts)
    of_tiles = {BESIDE: there & (wanted != NOWHERE), OTHERS: there & (wanted == NOWHERE)}
    for kind, name in names.items():
        if (some := of_tiles.get(kind)) is None:
            yield _row(case, name, chosen, bodies, None if kind == BODIES else target_of(NONE))
        elif some.any():
            yield _row(case, name, chosen[batch.sample[some]], right[some], target_of(kind))


def _row(
    case: Case, name: str, chosen: NDArray[np.int64], right: NDArray[np.bool_], target: Target | None
) -> Measurement:
    runs = Runs(case, chosen, Trajectory(right.astype(np.float32)[None]))
    return replace(measure("directions", name, runs, 1, target), steps=case.steps, convergence=None)
