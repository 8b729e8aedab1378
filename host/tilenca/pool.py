"""Tissues that live on from one iteration to the next, disturbed and undisturbed.

Training only ever looks at some ten updates at a time. A pool lets those be *any* ten of a long life: just
switched on, rebuilt into another drawing while running (tiles that stay keep their state), or long settled.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from tilenca.drawings import Batch, Drawings
from tilenca.recipes import Recipe

States = NDArray[np.float32]


@dataclass
class Pool:
    """Tissues and how long each has been left alone.

    Attributes:
        drawing: (P,) int64, the drawing each tissue has.
        states: (P, M, C) float32, states of its cells, unused places zero.
        age: (P,) int64, rounds since the last disturbance.
        life: (P,) int64, rounds after which a quiet tissue starts anew.
    """

    drawing: NDArray[np.int64]
    states: States
    age: NDArray[np.int64]
    life: NDArray[np.int64]


@dataclass(frozen=True)
class Taken:
    """A batch of B tissues from the pools.

    Attributes:
        batch: their cells.
        states: (N, C) float32.
        settled: (B,) bool, left alone for so long that nothing should change any more.
        late: (B,) bool, tissues to be switched on tile by tile.
    """

    batch: Batch
    states: States
    settled: NDArray[np.bool_]
    late: NDArray[np.bool_]


class Pools:
    """The busy and the quiet pool of one training run; without pools every sample is fresh."""

    def __init__(
        self, recipe: Recipe, drawings: Drawings, channels: int, random: np.random.Generator
    ) -> None:
        self.recipe = recipe
        self.drawings = drawings
        self.random = random
        self.channels = channels
        self.busy = self._fresh(recipe.pool)
        self.quiet = self._fresh(recipe.quiet_pool)

    def take(self) -> Taken:
        """Draws a batch, some of it disturbed."""
        recipe, random = self.recipe, self.random
        busy_count = recipe.batch - recipe.quiet_batch
        resets = 0
        if recipe.pool == 0:
            self.busy = self._fresh(busy_count)
            self._busy_taken = np.arange(busy_count)
        else:
            self._busy_taken = random.choice(recipe.pool, busy_count, replace=False)
            resets = round(recipe.reset * busy_count)
            switches = round(recipe.switch * busy_count)
            for number in self._busy_taken[:resets]:
                self.reset(self.busy, int(number))
            for number in self._busy_taken[resets : resets + switches]:
                self.switch(self.busy, int(number))
        self._quiet_taken = random.choice(max(recipe.quiet_pool, 1), recipe.quiet_batch, replace=False)
        for number in self._quiet_taken:
            if self.quiet.age[number] >= self.quiet.life[number]:
                self.reset(self.quiet, int(number))
        chosen = np.concatenate((self.busy.drawing[self._busy_taken], self.quiet.drawing[self._quiet_taken]))
        states = np.concatenate((self.busy.states[self._busy_taken], self.quiet.states[self._quiet_taken]))
        batch = self.drawings.batch(chosen)
        settled = np.zeros(recipe.batch, np.bool_)
        settled[busy_count:] = self.quiet.age[self._quiet_taken] >= recipe.quiet_rounds[0] // 2
        late = np.zeros(recipe.batch, np.bool_)
        late[:resets] = random.random(resets) < recipe.late
        return Taken(batch, states[batch.sample, batch.place], settled, late)

    def give_back(self, batch: Batch, states: States, rounds: int) -> None:
        """Stores what became of the batch last taken.

        Args:
            batch: the batch.
            states: (N, C) float32.
            rounds: how many rounds it lived.
        """
        padded = np.zeros((len(batch.starts), *self.busy.states.shape[1:]), np.float32)
        padded[batch.sample, batch.place] = states
        busy_count = len(self._busy_taken)
        self.busy.states[self._busy_taken] = padded[:busy_count]
        self.busy.age[self._busy_taken] += rounds
        self.quiet.states[self._quiet_taken] = padded[busy_count:]
        self.quiet.age[self._quiet_taken] += rounds

    def state(self) -> dict[str, Any]:
        """Everything that changes, as plain values and tensors for a checkpoint."""
        return {
            name: {field.name: torch.from_numpy(getattr(pool, field.name)) for field in fields(pool)}
            for name, pool in (("busy", self.busy), ("quiet", self.quiet))
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Takes back what `state` gave."""
        for name, pool in (("busy", self.busy), ("quiet", self.quiet)):
            for field in fields(pool):
                setattr(pool, field.name, state[name][field.name].cpu().numpy().copy())

    def _fresh(self, count: int) -> Pool:
        shape = (count, int(self.drawings.sizes.max()), self.channels)
        zeros = np.zeros(count, np.int64)
        pool = Pool(zeros.copy(), np.zeros(shape, np.float32), zeros.copy(), zeros.copy())
        for number in range(count):
            self.reset(pool, number)
        return pool

    def reset(self, pool: Pool, number: int) -> None:
        """Puts down any drawing anew, every tile in its seed state."""
        drawing = int(self.random.integers(len(self.drawings)))
        pool.drawing[number] = drawing
        pool.states[number] = 0.0
        pool.states[number, : self.drawings.sizes[drawing], 0] = 1.0
        pool.age[number] = 0
        pool.life[number] = self.random.integers(*self.recipe.quiet_rounds)

    def switch(self, pool: Pool, number: int) -> None:
        """Rebuilds a tissue into another drawing of its file; tiles that stay keep their state."""
        old = int(pool.drawing[number])
        groups = self.drawings.groups
        others = [n for n in range(len(self.drawings)) if groups[n] == groups[old] and n != old]
        if not others:
            return self.reset(pool, number)
        new = int(self.random.choice(others))
        stays = self.drawings.overlap(old, new, self.random)
        before = pool.states[number].copy()
        pool.drawing[number] = new
        pool.states[number] = 0.0
        pool.states[number, : len(stays), 0] = 1.0
        kept = np.flatnonzero(stays >= 0)
        pool.states[number, kept] = before[stays[kept]]
        pool.age[number] = 0
        return None
