"""Long rollouts with the EMA weights: they bring states into training that occur late, or rarely.

A batch covers some ten updates of a grid, and the weights change between two batches, so training hardly
shows a slow drift under one set of weights. The fast simulator runs the undisturbed grids for thousands of
updates with the integers of real tiles, and training goes on from their last states. The module also mines
hard
examples: it starts many drawings, rebuilds them, switches a tile off for a while, or gives them the states of
others. The few that do not agree in time go into the perturbed pool.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model
from tilenca.protocol.constants import STATE_MAX
from tilenca.shapes.batch import NO_CLASS, Drawings
from tilenca.simulator.conditions import Conditions, Fault
from tilenca.simulator.engine import SEED_STATE, FastEngine
from tilenca.simulator.simulator import MIXED, Simulator
from tilenca.simulator.transitions import Order, Way, rebuilt
from tilenca.training.pool import Pool, Pools
from tilenca.training.pool_batch import States

TICKS_PER_STEP = 3  # of training, about as many as one period of a tile there
CLOCKS = Conditions("clock", boot=0.0)
BEGINNINGS = (Conditions("random"), Conditions("clock"), Conditions("clock", loss=0.5))
ORDERS: tuple[Order, ...] = ("adding first", "mixed", "removing first")
SLOWLY = 15  # steps from one tile to the next
BEFORE, AGREED_BY = 50, 60  # steps before a disturbance, and steps after it in which the tiles must agree
REFRESHED = 128  # grids of the undisturbed pool at once
MOST_HARD_EXAMPLES = 1 / 8  # of the perturbed pool


def as_integers(states: States) -> NDArray[np.int16]:
    """The same states as tiles store them."""
    return np.rint(states * SEED_STATE).clip(-STATE_MAX, STATE_MAX).astype(np.int16)


def refresh_undisturbed(
    model: Model, pool: Pool, drawings: Drawings, steps: tuple[int, int], random: np.random.Generator
) -> None:
    """Runs some grids of a pool for some steps on tiles' clocks, without losses, and notes which are wrong.

    Args:
        model: the network.
        pool: the grids; states, ages and which ones are wrong are changed.
        drawings: the drawings that `pool.drawing` numbers.
        steps: least and most; the logarithm of the number is uniform between them.
        random: the only source of chance.
    """
    least, most = map(math.log, steps)
    count = round(math.exp(random.uniform(least, most)))
    some = random.permutation(len(pool.drawing))[:REFRESHED]
    batch = drawings.batch(pool.drawing[some])
    grid = some[batch.sample]
    states = as_integers(pool.states[grid, batch.place])
    simulator = Simulator(FastEngine(model), drawings, pool.drawing[some], CLOCKS, random, states)
    simulator.run(count)
    classes, answers = drawings.classes[pool.drawing[some]], simulator.answers()
    pool.wrong[some] = np.where(classes == NO_CLASS, answers == MIXED, answers != classes)
    pool.states[grid, batch.place] = simulator.states / np.float32(SEED_STATE)
    pool.age[some] += count * TICKS_PER_STEP


def mine_hard_examples(model: Model, pools: Pools, runs: int, random: np.random.Generator) -> int:
    """Puts whole drawings that do not agree in time into the perturbed pool, with their last states.

    Args:
        model: the network.
        pools: the destination.
        runs: drawings of the files to try with each kind of beginning, beside some of other sizes.
        random: the only source of chance.

    Returns:
        How many did not agree.
    """
    hard = []
    for trial, chosen, its_own in _trials(FastEngine(model), pools, runs, random):
        wrong = ~trial.run(AGREED_BY).agreed[-1]
        for run in np.flatnonzero(wrong):
            cells = (trial.batch.sample == run) & its_own
            hard.append((chosen[run], trial.states[cells] / np.float32(SEED_STATE)))
    most = round(len(pools.perturbed.age) * MOST_HARD_EXAMPLES)
    for number in random.permutation(len(hard))[:most]:
        pools.put(*hard[number])
    return len(hard)


Trial = tuple[Simulator, NDArray[np.int64], NDArray[np.bool_]]


def _trials(engine: FastEngine, pools: Pools, count: int, random: np.random.Generator) -> Iterator[Trial]:
    """Trials: whole drawings that start, are rebuilt, get a tile back, or have the states of other tiles.

    Yields:
        R runs, (R,) their drawings, and (N,) which cells belong to these.
    """
    drawings = pools.drawings

    def some() -> NDArray[np.int64]:
        return np.concatenate((pools.pick_whole(count, drawn=True), pools.pick_whole(count)))

    for conditions in BEGINNINGS:
        yield _whole(Simulator(engine, drawings, some(), conditions, random))

    # Rebuilt at once, and tile by tile: the small ones slowly, so that each drawing on the way lasts.
    for new, between in ((pools.pick_whole(count, drawn=True), SLOWLY), (pools.pick_whole(count), 1)):
        pairs = [(pools.pick_other(drawing), int(drawing)) for drawing in new]
        slowly = Way(ORDERS[int(random.integers(len(ORDERS)))], between)
        for mine, way in ((slice(0, None, 2), Way()), (slice(1, None, 2), slowly)):
            if pairs[mine]:
                built, its_own = rebuilt(engine, drawings, pairs[mine], BEFORE, random, way)
                yield built, new[mine], its_own

    chosen = some()
    away = Fault("away", random.integers(drawings.sizes[chosen]), BEFORE // 2, BEFORE)
    back = Simulator(engine, drawings, chosen, Conditions("clock", fault=away), random)
    back.run(BEFORE)
    yield _whole(back)

    chosen = some()
    states = as_integers(pools.any_states(int(drawings.sizes[chosen].sum())))
    yield _whole(Simulator(engine, drawings, chosen, CLOCKS, random, states))


def _whole(runs: Simulator) -> Trial:
    """Runs that consist of their drawings' cells."""
    return runs, runs.chosen, np.ones(runs.cells, np.bool_)
