"""Rollouts of any engine in numpy, tick by tick, on the schedule of the compiled `rollout_library`."""

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import SIDES, opposite
from tilenca.simulator.engine import Engine, States
from tilenca.simulator.rollout_library import DARK, Plan, Setup


class RoundByRound:
    """`Tissue` for an engine that is not the firmware's core.

    Args:
        engine: what a cell computes.
        setup: the runs.
        states: (N, C) of the engine's type; changed in place.
        shown: (N,) int8, the class each tile shows, `DARK` for none; changed in place.
    """

    def __init__(self, engine: Engine, setup: Setup, states: States, shown: NDArray[np.int8]) -> None:
        self.engine, self.setup, self.states, self.shown = engine, setup, states, shown
        self.plan, self.updates = Plan(setup), 0
        self.own = engine.message(states)
        # What each cell holds of its N, E, S, W neighbour; the last row is nobody's.
        self.heard = np.zeros((len(states) + 1, len(SIDES), engine.channels), self.own.dtype)
        self.asked = setup.alive.copy()
        if setup.fault != "away":
            self.asked[setup.faulty[setup.faulty >= 0]] = False

    def run(self, right: NDArray[np.float32], shown: NDArray[np.int8] | None, threads: int) -> None:
        """As `Tissue.run`, by one thread whatever `threads` is."""
        del threads
        starts = self.setup.starts[:-1]
        total = np.add.reduceat(self.asked, starts, dtype=np.float32)
        for step in range(len(right)):
            while not self._live():
                pass
            good = self.asked & (self.shown == self.setup.target)
            right[step] = np.add.reduceat(good, starts, dtype=np.float32) / total
            if shown is not None:
                shown[step] = self.shown

    def _live(self) -> bool:
        """Carries out one round; true when it is the last one of a step."""
        rounds = self.plan.next()
        self.shown[rounds.gone] = DARK
        self.states[rounds.born] = self.engine.seed(len(rounds.born))
        self.own[rounds.born] = self.engine.message(self.states[rounds.born])
        self.heard[rounds.born] = 0
        neighbours = self.setup.neighbours[rounds.senders]
        for side in range(len(SIDES)):
            arrives = rounds.arrives[:, side]
            self.heard[neighbours[arrives, side], opposite(side)] = self.own[rounds.senders[arrives]]
        self._update(rounds.updating, rounds.absent)
        return rounds.last

    def _update(self, who: NDArray[np.int32], absent: NDArray[np.bool_]) -> None:
        if not len(who):
            return
        heard = self.heard[who]
        heard[absent] = 0
        seen = np.concatenate((self.own[who], heard.reshape(len(who), -1)), axis=1)
        new = self.engine.update(self.states[who], seen)
        self.states[who], self.own[who] = new, self.engine.message(new)
        self.shown[who] = new[:, -self.engine.classes :].argmax(axis=1)
        self.updates += len(who)
