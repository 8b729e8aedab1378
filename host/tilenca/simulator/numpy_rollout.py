"""Rollouts of any engine in numpy, tick by tick, on the schedule of the compiled `rollout_library`."""

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import SIDES, opposite
from tilenca.simulator.engine import Engine, States
from tilenca.simulator.rollout_library import DARK, Setup, TickSchedule


class NumpyRollout:
    """`CompiledRollout` for an engine that is not the firmware's core.

    Args:
        engine: computes the cells' updates.
        setup: the runs.
        states: (N, C) of the engine's type; changed in place.
        shown: (N,) int8, the class each tile shows, `DARK` for none; changed in place.
    """

    def __init__(self, engine: Engine, setup: Setup, states: States, shown: NDArray[np.int8]) -> None:
        self.engine, self.setup, self.states, self.shown = engine, setup, states, shown
        self.schedule, self.updates = TickSchedule(setup), 0
        self.own = engine.message(states)
        # The message that each cell holds of its N, E, S, W neighbour; the last row stands for no cell.
        self.received = np.zeros((len(states) + 1, len(SIDES), engine.channels), self.own.dtype)
        self.counted = setup.alive.copy()
        self.faulty = setup.faulty[setup.faulty >= 0]  # counts all the time when it is away, else never
        self.counted[self.faulty] &= setup.fault == "away"

    def run(self, right: NDArray[np.float32], shown: NDArray[np.int8] | None, threads: int) -> None:
        """As `CompiledRollout.run`, but always in one thread."""
        del threads
        starts = self.setup.starts[:-1]
        for step in range(len(right)):
            while not self._tick():
                pass
            good = self.counted & (self.shown == self.setup.target)
            total = np.add.reduceat(self.counted, starts, dtype=np.float32)
            right[step] = np.add.reduceat(good, starts, dtype=np.float32) / np.maximum(total, 1)
            if shown is not None:
                shown[step] = self.shown

    def _tick(self) -> bool:
        """Carries out one tick; true when it is the last one of a step."""
        tick = self.schedule.next()
        self.shown[tick.gone] = DARK
        self.counted[np.setdiff1d(tick.gone, self.faulty)] = False
        self.counted[np.setdiff1d(tick.born, self.faulty)] = True
        self.states[tick.born] = self.engine.seed(len(tick.born))
        self.own[tick.born] = self.engine.message(self.states[tick.born])
        self.received[tick.born] = 0
        neighbours = self.setup.neighbours[tick.senders]
        for side in range(len(SIDES)):
            arrives = tick.arrives[:, side]
            self.received[neighbours[arrives, side], opposite(side)] = self.own[tick.senders[arrives]]
        self._update(tick.updating, tick.absent)
        return tick.last

    def _update(self, cells: NDArray[np.int32], absent: NDArray[np.bool_]) -> None:
        if not len(cells):
            return
        received = self.received[cells]
        received[absent] = 0
        seen = np.concatenate((self.own[cells], received.reshape(len(cells), -1)), axis=1)
        new = self.engine.update(self.states[cells], seen)
        self.states[cells], self.own[cells] = new, self.engine.message(new)
        self.shown[cells] = new[:, -self.engine.classes :].argmax(axis=1)
        self.updates += len(cells)
