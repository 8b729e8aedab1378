"""The order of updates in training, and the messages that neighbours have received by then.

Both schedules become the same list of updates, so that one loop trains on a mixture of them:

- the paper's sampler: in every tick each tile updates with the sample's fire rate, and its neighbours receive
  the message at once;
- the tiles' own clocks: each tile updates once per period, with a phase and a slightly different period of
  its own, and its neighbours read its last message a little after it was sent.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch
from tilenca.training.recipe import Recipe

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class UpdateSchedule:
    """E updates in T ticks of N cells.

    Attributes:
        counts: (T,) int64, updates of each tick.
        updating: (E,) int32, the cell of each update, tick by tick.
        reads: (E, 5) int32, the rows that it perceives of a table of messages: 0..N-1 are the cells' own,
            N..2N-1 are those that neighbours have received, 2N stands for an absent neighbour and for a lost
            message.
        arrives: (T, N) bool, whether neighbours receive the cell's current message at the end of the tick.
        starts: (B,) int64, the first cell of each of B independent samples.
    """

    counts: NDArray[np.int64]
    updating: NDArray[np.int32]
    reads: NDArray[np.int32]
    arrives: Flags
    starts: NDArray[np.int64]

    def parts(self, wanted: int) -> "Iterator[tuple[slice, UpdateSchedule]]":
        """Splits the samples into `wanted` parts of about one size: the cells and the schedule of each."""
        ticks, cells = self.arrives.shape
        when = np.repeat(np.arange(ticks), self.counts)
        places = np.append(self.starts, cells)
        ends = [places[np.searchsorted(places, cells * part // wanted)] for part in range(1, wanted)]
        for first, last in pairwise((0, *ends, cells)):
            mine = (self.updating >= first) & (self.updating < last)
            reads = self.reads[mine]
            received, absent = reads >= cells, reads == 2 * cells
            reads -= np.where(received, cells + first - (last - first), first).astype(np.int32)
            reads[absent] = 2 * (last - first)
            yield (
                slice(first, last),
                UpdateSchedule(
                    np.bincount(when[mine], minlength=ticks),
                    self.updating[mine] - np.int32(first),
                    reads,
                    self.arrives[:, first:last],
                    self.starts[(self.starts >= first) & (self.starts < last)] - first,
                ),
            )

    def by_cell(self) -> tuple[Flags, Flags, NDArray[np.int64]]:
        """(T, N) cells that fire, (T, N) arrivals, (T, N, 4) int64 cells that each cell reads, N for none."""
        ticks, cells = self.arrives.shape
        when = np.repeat(np.arange(ticks), self.counts)
        fires = np.zeros((ticks, cells), np.bool_)
        fires[when, self.updating] = True
        neighbours = np.full((ticks, cells, 4), cells, np.int64)
        neighbours[when, self.updating] = self.reads[:, 1:] - cells
        return fires, self.arrives, neighbours


@dataclass(frozen=True)
class Circumstances:
    """The circumstances of B samples of N cells during a rollout.

    Attributes:
        staggered: (B,) samples whose tiles are switched on at any time within the rollout.
        away: (N,) tiles that are off all the time.
        lossless: (B,) samples that lose no message.
        fresh: (N,) tiles in the seed state, which have sent nothing yet.
    """

    staggered: Flags
    away: Flags
    lossless: Flags
    fresh: Flags


def draw_schedule(
    recipe: Recipe,
    batch: Batch,
    lengths: NDArray[np.int64],
    random: np.random.Generator,
    given: Circumstances,
) -> UpdateSchedule:
    """Draws one schedule for a batch: each sample on clocks or not, lossy or not, at its own rates.

    Args:
        recipe: the shares and rates.
        batch: B drawings of N cells in all.
        lengths: (B,) ticks of each sample's rollout; T is the longest.
        random: the only source of chance.
        given: the other circumstances of the samples.
    """
    cells, ticks = len(batch.sample), int(lengths.max())
    length = lengths[batch.sample]
    fires, arrives, strict = _draw_ticks(recipe, batch, ticks, random, given)
    boot = np.where(given.away, length, random.integers(0, length) * given.staggered[batch.sample])
    now = np.arange(ticks)[:, None]
    fires &= (now < length) & (now >= boot)
    when, updating = np.nonzero(fires)
    neighbours = batch.neighbours[updating]
    known = np.where(given.fresh & strict, _first_received(fires, arrives), boot)
    if known.any():
        neighbours[np.append(known, 0)[neighbours] > when[:, None]] = cells
    if recipe.lossy > 0:
        neighbours[_draw_losses(recipe, batch, (when, updating), ticks, random, given)] = cells
    reads = np.concatenate((updating[:, None], neighbours + cells), axis=1).astype(np.int32)
    return UpdateSchedule(
        np.bincount(when, minlength=ticks), updating.astype(np.int32), reads, arrives, batch.starts
    )


def _draw_ticks(
    recipe: Recipe, batch: Batch, ticks: int, random: np.random.Generator, given: Circumstances
) -> tuple[Flags, Flags, Flags]:
    """Draws the ticks in which cells fire and in which their messages arrive, as if all were switched on.

    Returns:
        (T, N) fires, (T, N) arrives, and (N,) strict: a strict cell is absent for its neighbours until they
        have received one of its messages.
    """
    samples, cells = len(batch.starts), len(batch.sample)
    rate = random.uniform(*recipe.fire_rate, samples)[batch.sample]
    fires = random.random((ticks, cells), dtype=np.float32) < rate.astype(np.float32)
    arrives = np.ones((ticks, cells), dtype=np.bool_)
    strict = np.zeros(cells, np.bool_)
    if recipe.clocks > 0:
        strict = (random.random(samples) < recipe.clocks)[batch.sample]
        on_clock = np.flatnonzero(strict)
        fires[:, on_clock], arrives[:, on_clock] = _clocks(recipe, batch, on_clock, ticks, random)
    if recipe.stale > 0:
        stale = _draw_shares(recipe.max_stale, recipe.stale, random, given)
        strict |= stale[batch.sample] > 0
        some = np.flatnonzero(stale[batch.sample])
        arrives[:, some] &= random.random((ticks, len(some)), dtype=np.float32) >= stale[batch.sample[some]]
    return fires, arrives, strict


def _draw_losses(
    recipe: Recipe,
    batch: Batch,
    updates: tuple[NDArray[np.int64], NDArray[np.int64]],
    ticks: int,
    random: np.random.Generator,
    given: Circumstances,
) -> Flags:
    """(E, 4) the neighbours' messages that are lost for each update; a loss lasts for some ticks.

    Args:
        recipe: the shares.
        batch: the drawings.
        updates: (E,) the tick and (E,) the cell of each update.
        ticks: T.
        random: the only source of chance.
        given: the samples that lose no message.
    """
    when, updating = updates
    loss = _draw_shares(recipe.max_loss, recipe.lossy, random, given)
    lasts = random.integers(1, recipe.longest_loss + 1, len(batch.starts))
    fate = random.random((ticks, len(batch.sample), 4), dtype=np.float32)[
        when // lasts[batch.sample][updating], updating
    ]
    lost: Flags = fate < loss[batch.sample][updating, None]
    return lost


def _draw_shares(
    most: float, affected: float, random: np.random.Generator, given: Circumstances
) -> NDArray[np.float64]:
    """(B,) share of its messages that each sample loses; 0 where it is lossless or not affected.

    Args:
        most: the largest share.
        affected: the share of samples that are affected.
        random: the only source of chance.
        given: the samples that lose no message.
    """
    samples = len(given.lossless)
    return random.uniform(0, most, samples) * (random.random(samples) < affected) * ~given.lossless


def _first_received(fires: Flags, arrives: Flags) -> NDArray[np.int64]:
    """(N,) the first tick in which neighbours have a message of a cell; T where they never have one."""
    sent = np.logical_or.accumulate(fires, axis=0)
    received = sent & arrives
    return np.where(received.any(axis=0), received.argmax(axis=0) + 1, len(received))


def _clocks(
    recipe: Recipe, batch: Batch, updating: NDArray[np.int64], ticks: int, random: np.random.Generator
) -> tuple[Flags, Flags]:
    """(T, cells in `updating`) when those cells update, and when their current message arrives."""
    period = random.uniform(*recipe.ticks_per_period, len(batch.starts))[batch.sample[updating]]
    period = period * (1 + random.uniform(-recipe.drift, recipe.drift, len(updating)))
    phase = random.random(len(updating))
    latency = random.uniform(*recipe.latency, len(updating))
    # A tile updates in the ticks in which the count of its periods grows.
    periods = np.arange(ticks + 1)[:, None] / period + phase
    return np.diff(np.floor(periods), axis=0) > 0, np.diff(np.floor(periods - latency), axis=0) > 0
