"""How much there is to compute in the measurements of a model, counted without computing it."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.cases import Case
from tilenca.evaluation.evaluator import AT_ONCE, CONVERGED_BY, Evaluator
from tilenca.evaluation.metrics import Measurement, Runs
from tilenca.evaluation.suites import Suite
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import Engine
from tilenca.simulator.simulator import Trajectory
from tilenca.simulator.transitions import Way, pairs_of


class Work(NamedTuple):
    """The work of a table of measurements: its rows, and the updates of tiles in them."""

    rows: int
    updates: int


def work_of(engine: Engine, suite: Suite, runs: int) -> Work:
    """The work of measuring a suite; the updates of changes tile by tile are about as many.

    Args:
        engine: of a model with these classes; it computes nothing here.
        suite: the cases to measure.
        runs: of each drawing, as of `Evaluator`.
    """
    workload = _Workload(engine, suite, runs, seed=0)
    rows = sum(1 for _ in workload.rows()) + len(suite.dead) + sum(len(each.rows) for each in suite.missing)
    return Work(rows, workload.updates)


def rows_during_training(engine: Engine, suite: Suite) -> int:
    """How many rows the short measurements during training have, see `Evaluator.short_rows`."""
    rows = sum(1 for _ in _Workload(engine, suite, runs=1, seed=0).short_rows())
    return rows + len(suite.dead) + sum(len(each.rows) for each in suite.missing)


class _Workload(Evaluator):
    """Takes every run as one that was right from the start.

    Attributes:
        updates: that the runs so far would have taken.
    """

    updates = 0

    def dead(self) -> Iterator[Measurement]:
        """Many dead tiles; the best guess, which takes long, is left out."""
        for case in self.suite.dead:
            self._run(case.name, case, Conditions("clock", dead=case.dead), case.steps)
        yield from ()

    def missing(self) -> Iterator[Measurement]:
        """Where tiles say that one is missing."""
        for asked in self.suite.missing:
            steps = asked.case.steps if asked.dies is None else CONVERGED_BY + 2 * asked.case.steps
            count = len(asked.case.drawings) if asked.dies is None else len(asked.dies)
            tiles = sum(asked.case.drawings.sizes) / len(asked.case.drawings)
            self.updates += round(tiles * count * max(1, 10 * self.runs // count) * steps)
        yield from ()

    def _changed(self, case: Case, each: int, random: np.random.Generator, way: Way) -> Runs | None:
        pairs = pairs_of(case.drawings, each, random)
        if not pairs:
            return None
        cells = [set(shape.cells) for shape in case.drawings.shapes]
        changes = 1 if way is AT_ONCE else max(len(cells[old] ^ cells[new]) for old, new in set(pairs))
        steps = CONVERGED_BY + (changes - 1) * way.between + case.steps
        self.updates += sum(len(cells[old] | cells[new]) for old, new in pairs) * steps
        return self._right(case, np.array([new for _, new in pairs]), case.steps)

    def _run(
        self, name: str, case: Case, conditions: Conditions, *marks: int, each: int | None = None
    ) -> Runs:
        chosen = self._every_drawing(case, self.runs if each is None else each)
        self.updates += int(np.array(case.drawings.sizes)[chosen].sum()) * marks[-1]
        return self._right(case, chosen, *marks)

    @staticmethod
    def _right(case: Case, chosen: NDArray[np.int64], *marks: int) -> Runs:
        right = np.ones((marks[-1], len(chosen)), np.float32)
        return Runs(case, chosen, Trajectory(right), dict.fromkeys(marks, case.drawings.classes[chosen]))
