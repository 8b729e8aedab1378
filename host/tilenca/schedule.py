"""Which tile updates when, in training, and what its neighbours have heard of it by then.

Both schedules become the same three arrays, so that one loop trains on a mixture of them:

- the paper's sampler: in every round each tile updates with the sample's fire rate, and is heard at once;
- the tiles' own clocks: each tile updates once per period at its own phase, its period slightly its own, and
  its neighbours read what it sent last, a little after it was sent.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.drawings import Batch
from tilenca.recipes import Recipe


@dataclass(frozen=True)
class Schedule:
    """What happens in each of T rounds to each of N cells.

    Attributes:
        fires: (T, N) bool, the cell updates.
        arrives: (T, N) bool, at the end of the round the neighbours hear the cell's message of then.
        neighbours: (T, N, 4) int64, whom the cell reads; N for nobody, or for a message that is lost.
    """

    fires: NDArray[np.bool_]
    arrives: NDArray[np.bool_]
    neighbours: NDArray[np.int64]


def draw_schedule(
    recipe: Recipe,
    batch: Batch,
    rounds: int,
    random: np.random.Generator,
    late: NDArray[np.bool_] | None = None,
) -> Schedule:
    """Draws one schedule for a batch: each sample on clocks or not, lossy or not, at its own rates.

    Args:
        recipe: how.
        batch: B drawings of N cells in all.
        rounds: T.
        random: the only source of chance.
        late: (B,) whose tiles are switched on at any time within the T rounds; None: nobody's.
    """
    samples, cells = len(batch.starts), len(batch.sample)
    rate = random.uniform(*recipe.fire_rate, samples)[batch.sample]
    fires = random.random((rounds, cells), dtype=np.float32) < rate
    arrives = np.ones((rounds, cells), dtype=np.bool_)
    if recipe.clocks > 0:
        on_clock = (random.random(samples) < recipe.clocks)[batch.sample]
        ticks, heard = _clocks(recipe, batch, rounds, random)
        fires = np.where(on_clock, ticks, fires)
        arrives = np.where(on_clock, heard, arrives)
    neighbours = np.broadcast_to(batch.neighbours, (rounds, cells, 4))
    if recipe.lossy > 0:
        loss = random.uniform(0, recipe.max_loss, samples) * (random.random(samples) < recipe.lossy)
        lost = random.random((rounds, cells, 4), dtype=np.float32) < loss[batch.sample][:, None]
        neighbours = np.where(lost, cells, neighbours)
    if late is not None and late.any():
        boot = np.append(random.integers(0, rounds, cells) * late[batch.sample], 0)
        asleep = np.arange(rounds)[:, None] < boot
        fires = fires & ~asleep[:, :-1]
        neighbours = np.where(asleep[np.arange(rounds)[:, None, None], neighbours], cells, neighbours)
    return Schedule(fires, arrives, neighbours)


def _clocks(
    recipe: Recipe, batch: Batch, rounds: int, random: np.random.Generator
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    samples, cells = len(batch.starts), len(batch.sample)
    period = random.uniform(*recipe.rounds_per_period, samples)[batch.sample]
    period = period * (1 + random.uniform(-recipe.drift, recipe.drift, cells))
    phase = random.random(cells)
    latency = random.uniform(*recipe.latency, cells)
    # A tile has ticked in a round when the count of its periods grew in it.
    periods = np.arange(rounds + 1)[:, None] / period + phase
    return np.diff(np.floor(periods), axis=0) > 0, np.diff(np.floor(periods - latency), axis=0) > 0
