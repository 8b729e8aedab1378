"""Batches of grids on the schedule of real tiles or of the paper, thousands at a time.

A `Simulator` owns many runs side by side as one flat list of cells. An `Engine` computes the cells.
`FastEngine` is the firmware's own core, compiled together with the schedule (`rollout_library`). Any other
engine, such as tensors (`tilenca.training.float_engine`), follows the same schedule in numpy
(`numpy_rollout`).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.base.processors import processors
from tilenca.shapes.batch import Drawings
from tilenca.simulator.chance import draw_setup
from tilenca.simulator.conditions import Conditions, Rebuilding
from tilenca.simulator.engine import Engine, FastEngine, States
from tilenca.simulator.numpy_rollout import NumpyRollout
from tilenca.simulator.rollout_library import DARK, NOBODY, CompiledRollout

# Cell updates between two checks for Ctrl-C: some tenths of a second.
ATTENTION = 500_000
MIXED = -2  # the answer of a run whose tiles show different classes


@dataclass(frozen=True)
class Trajectory:
    """The results of runs, step by step.

    Attributes:
        right: (T, R) float32, share of the run's counted tiles that show its class after each step.
        shown: (T, N) int8, the class each tile shows after each step, -1 for dark; None: not recorded.
    """

    right: NDArray[np.float32]
    shown: NDArray[np.int8] | None = None

    @property
    def agreed(self) -> NDArray[np.bool_]:
        """(T, R) whether all tiles of the run are right after each step."""
        return self.right >= 1.0

    @property
    def converged_at(self) -> NDArray[np.float64]:
        """(R,) first step (from 1) from which the run stays right to the end; infinite for none."""
        wrong = ~self.agreed
        last_wrong = np.where(wrong.any(axis=0), len(wrong) - np.argmax(wrong[::-1], axis=0), 0)
        return np.where(last_wrong < len(wrong), last_wrong + 1.0, np.inf)


class Simulator:
    """R independent runs side by side.

    Args:
        engine: computes the cells' updates.
        drawings: the task.
        chosen: (R,) the drawing of each run.
        conditions: of all runs.
        random: the only source of chance; it is used here only, not during the runs.
        states: (N, C) of tiles that run already, with phases of their own, cells in the order of
            `drawings.batch(chosen)`; None: all tiles are switched on.
        rebuilding: tiles put down and taken away; None: none.
        threads: how many to use, None: one per processor; results do not depend on it.

    Attributes:
        chosen: (R,) the drawing of each run.
        batch: the cells.
        states: (N, C) current states; not to be written to.
        shown: (N,) int8, the class each tile shows now, -1 for dark.
        alive: (N,) whether a tile is there at the start, and not one of `conditions.dead`.
        setup: the random choices of all runs, drawn beforehand.

    Raises:
        ValueError: `states` or `conditions.fault` do not fit the runs, or a run has no tile that counts.
    """

    def __init__(
        self,
        engine: Engine,
        drawings: Drawings,
        chosen: NDArray[np.int64],
        conditions: Conditions,
        random: np.random.Generator,
        states: States | None = None,
        *,
        rebuilding: Rebuilding | None = None,
        threads: int | None = None,
    ) -> None:
        self.threads = processors() if threads is None else threads
        self.chosen = chosen
        self.batch = batch = drawings.batch(chosen)
        self.cells = cells = len(batch.sample)
        self.states = engine.seed(cells) if states is None else np.array(states, order="C")
        if self.states.shape != (cells, engine.channels):
            raise ValueError(f"states are {self.states.shape}, the runs need {(cells, engine.channels)}")
        self.shown = np.full(cells, DARK, np.int8)
        self.setup = draw_setup(batch, conditions, random, states is not None, rebuilding)
        self.alive = self.setup.alive
        self._steps = 0
        self._rollout: CompiledRollout | NumpyRollout
        if isinstance(engine, FastEngine):
            self._rollout = CompiledRollout(engine.model, self.setup, self.states, self.shown)
        else:
            self._rollout = NumpyRollout(engine, self.setup, self.states, self.shown)

    def run(
        self, steps: int, record: bool = False, tell: Callable[[int], None] = lambda done: None
    ) -> Trajectory:
        """Runs some more steps.

        Args:
            steps: how many.
            record: whether to keep the class that every tile shows after each step.
            tell: called at intervals with the number of steps done.
        """
        right = np.empty((steps, len(self.batch.starts)), np.float32)
        shown = np.empty((steps, self.cells), np.int8) if record else None
        stride = max(1, ATTENTION * self.threads // self.cells)
        for step in range(0, steps, stride):
            part = slice(step, step + stride)
            self._rollout.run(right[part], None if shown is None else shown[part], self.threads)
            tell(min(step + stride, steps))
        self._steps += steps
        return Trajectory(right, shown)

    @property
    def counted(self) -> NDArray[np.bool_]:
        """(N,) the tiles that count now: those that are there, without the dead and the stuck."""
        counted = self.setup.alive.copy()
        counted[self.setup.faulty[self.setup.faulty != NOBODY]] &= self.setup.fault == "away"
        done = self.setup.changes[self.setup.changes[:, 0] < self._steps]
        for _, cell, on in done:
            counted[cell] = on
        return counted

    def answers(self) -> NDArray[np.int64]:
        """(R,) the class that all counted tiles of a run show now, `DARK`, or `MIXED` where they differ."""
        counted, starts = self.counted, self.batch.starts
        shown = self.shown.astype(np.int64)
        most = np.maximum.reduceat(np.where(counted, shown, MIXED), starts)
        least = np.minimum.reduceat(np.where(counted, shown, np.iinfo(np.int64).max), starts)
        return np.where(most == least, most, MIXED)

    @property
    def updates(self) -> int:
        """The number of cell updates computed in all."""
        return self._rollout.updates
