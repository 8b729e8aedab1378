"""Which tile updates when, in training, and what its neighbours have heard of it by then.

Both schedules become the same list of updates, so that one loop trains on a mixture of them:

- the paper's sampler: in every round each tile updates with the sample's fire rate, and is heard at once;
- the tiles' own clocks: each tile updates once per period at its own phase, its period slightly its own, and
  its neighbours read what it sent last, a little after it was sent.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch
from tilenca.training.recipes import Recipe

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Schedule:
    """E updates in T rounds of N cells.

    Attributes:
        counts: (T,) int64, updates of each round.
        who: (E,) int32, which cell updates, round by round.
        reads: (E, 5) int32, the rows it perceives of a table of messages: own 0..N-1, as neighbours have
            heard them N..2N-1, 2N for nobody's, or for a message that is lost.
        arrives: (T, N) bool, at the end of the round the neighbours hear the cell's message of then.
        starts: (B,) int64, the first cell of each of B samples, which know nothing of each other.
    """

    counts: NDArray[np.int64]
    who: NDArray[np.int32]
    reads: NDArray[np.int32]
    arrives: Flags
    starts: NDArray[np.int64]

    def parts(self, wanted: int) -> "Iterator[tuple[slice, Schedule]]":
        """The schedules of some samples each, and which cells they are: `wanted` parts of about one size."""
        rounds, cells = self.arrives.shape
        when = np.repeat(np.arange(rounds), self.counts)
        places = np.append(self.starts, cells)
        ends = [places[np.searchsorted(places, cells * part // wanted)] for part in range(1, wanted)]
        for first, last in pairwise((0, *ends, cells)):
            mine = (self.who >= first) & (self.who < last)
            reads = self.reads[mine]
            heard, nobody = reads >= cells, reads == 2 * cells
            reads -= np.where(heard, cells + first - (last - first), first).astype(np.int32)
            reads[nobody] = 2 * (last - first)
            yield (
                slice(first, last),
                Schedule(
                    np.bincount(when[mine], minlength=rounds),
                    self.who[mine] - np.int32(first),
                    reads,
                    self.arrives[:, first:last],
                    self.starts[(self.starts >= first) & (self.starts < last)] - first,
                ),
            )

    def by_cell(self) -> tuple[Flags, Flags, NDArray[np.int64]]:
        """(T, N) who fires, (T, N) who arrives, (T, N, 4) int64 whom each cell reads, N for nobody."""
        rounds, cells = self.arrives.shape
        when = np.repeat(np.arange(rounds), self.counts)
        fires = np.zeros((rounds, cells), np.bool_)
        fires[when, self.who] = True
        neighbours = np.full((rounds, cells, 4), cells, np.int64)
        neighbours[when, self.who] = self.reads[:, 1:] - cells
        return fires, self.arrives, neighbours


@dataclass(frozen=True)
class Circumstances:
    """What B samples of N cells live through.

    Attributes:
        late: (B,) whose tiles are switched on at any time within their life.
        away: (N,) tiles that are off all the time.
        calm: (B,) samples that lose no message.
        fresh: (N,) tiles in the seed state, from which nobody has heard yet.
    """

    late: Flags
    away: Flags
    calm: Flags
    fresh: Flags


def draw_schedule(
    recipe: Recipe,
    batch: Batch,
    lives: NDArray[np.int64],
    random: np.random.Generator,
    given: Circumstances,
) -> Schedule:
    """Draws one schedule for a batch: each sample on clocks or not, lossy or not, at its own rates.

    Args:
        recipe: how.
        batch: B drawings of N cells in all.
        lives: (B,) rounds that each sample lives; T is the longest.
        random: the only source of chance.
        given: what else the samples live through.
    """
    samples, cells, rounds = len(batch.starts), len(batch.sample), int(lives.max())
    life = lives[batch.sample]

    def share(most: float, affected: float) -> NDArray[np.float64]:
        """(B,) of its messages that each sample loses; nothing in those that are calm."""
        return random.uniform(0, most, samples) * (random.random(samples) < affected) * ~given.calm

    now = np.arange(rounds)[:, None]
    rate = random.uniform(*recipe.fire_rate, samples)[batch.sample]
    fires = random.random((rounds, cells), dtype=np.float32) < rate.astype(np.float32)
    arrives = np.ones((rounds, cells), dtype=np.bool_)
    strict = np.zeros(cells, np.bool_)  # whoever has sent nothing that arrived is nobody
    if recipe.clocks > 0:
        strict = (random.random(samples) < recipe.clocks)[batch.sample]
        on_clock = np.flatnonzero(strict)
        fires[:, on_clock], arrives[:, on_clock] = _clocks(recipe, batch, on_clock, rounds, random)
    if recipe.unheard > 0:
        unheard = share(recipe.max_unheard, recipe.unheard)
        strict |= unheard[batch.sample] > 0
        some = np.flatnonzero(unheard[batch.sample])
        arrives[:, some] &= (
            random.random((rounds, len(some)), dtype=np.float32) >= unheard[batch.sample[some]]
        )
    boot = np.where(given.away, life, random.integers(0, life) * given.late[batch.sample])
    fires &= (now < life) & (now >= boot)
    when, who = np.nonzero(fires)
    neighbours = batch.neighbours[who]
    known = np.where(given.fresh & strict, _first_heard(fires, arrives), boot)
    if known.any():
        neighbours[np.append(known, 0)[neighbours] > when[:, None]] = cells
    if recipe.lossy > 0:
        loss = share(recipe.max_loss, recipe.lossy)
        lasts = random.integers(1, recipe.longest_loss + 1, samples)
        fate = random.random((rounds, cells, 4), dtype=np.float32)[when // lasts[batch.sample][who], who]
        neighbours[fate < loss[batch.sample][who, None]] = cells
    reads = np.concatenate((who[:, None], neighbours + cells), axis=1).astype(np.int32)
    return Schedule(np.bincount(when, minlength=rounds), who.astype(np.int32), reads, arrives, batch.starts)


def _first_heard(fires: Flags, arrives: Flags) -> NDArray[np.int64]:
    """(N,) the first round in which neighbours know of a cell; T where they never do."""
    sent = np.logical_or.accumulate(fires, axis=0)
    heard = sent & arrives
    return np.where(heard.any(axis=0), heard.argmax(axis=0) + 1, len(heard))


def _clocks(
    recipe: Recipe, batch: Batch, who: NDArray[np.int64], rounds: int, random: np.random.Generator
) -> tuple[Flags, Flags]:
    """(T, cells in `who`) when those cells tick, and when what they then sent is heard."""
    period = random.uniform(*recipe.rounds_per_period, len(batch.starts))[batch.sample[who]]
    period = period * (1 + random.uniform(-recipe.drift, recipe.drift, len(who)))
    phase = random.random(len(who))
    latency = random.uniform(*recipe.latency, len(who))
    # A tile has ticked in a round when the count of its periods grew in it.
    periods = np.arange(rounds + 1)[:, None] / period + phase
    return np.diff(np.floor(periods), axis=0) > 0, np.diff(np.floor(periods - latency), axis=0) > 0
