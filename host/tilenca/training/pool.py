"""Tissues that live on from one iteration to the next, disturbed and undisturbed.

Training only ever looks at some ten updates at a time. A pool lets those be *any* ten of a long life: just
switched on, rebuilt into another drawing while running (tiles that stay keep their state), or long settled.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch
from tilenca.training.curriculum import Curriculum
from tilenca.training.recipes import Recipe
from tilenca.training.update_schedule import Circumstances

States = NDArray[np.float32]
FORGETS = 0.1  # weight of the newest result in a drawing's share of failures
QUIET_DRAWN = 0.5  # share of the quiet pool that has the files' own drawings, which must last
HAD_TIME = 40  # rounds undisturbed after which a wrong tile counts as a failure


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
        given: what they live through; tiles that are away will be back in the seed state when the tissue is
            next taken, and those of the quiet pool are calm.
    """

    batch: Batch
    states: States
    settled: NDArray[np.bool_]
    given: Circumstances

    @property
    def asked(self) -> NDArray[np.bool_]:
        """(B,) whether a tissue must be right: it is all there, and was from the beginning."""
        return ~(self.given.late | np.logical_or.reduceat(self.given.away, self.batch.starts))


class Pools:
    """The busy and the quiet pool of one training run; without pools every sample is fresh."""

    def __init__(
        self, recipe: Recipe, curriculum: Curriculum, channels: int, random: np.random.Generator
    ) -> None:
        self.recipe = recipe
        self.drawings = drawings = curriculum.drawings
        self.curriculum = curriculum
        self.random = random
        self.channels = channels
        self._seed = np.eye(1, channels, dtype=np.float32)
        # How often a drawing failed lately, 0..1; all are thought to fail until they were seen.
        self.failures = np.ones(len(drawings))
        groups = np.array(drawings.groups)
        self._same_scale = [np.flatnonzero(groups == group) for group in range(groups.max() + 1)]
        self._everything = np.arange(len(drawings))
        self._whole = np.flatnonzero(curriculum.whole)
        self._drawn = np.flatnonzero(curriculum.whole & (groups < len(drawings.sources)))
        self._weigh(0.0)
        self.busy = self._empty(recipe.pool)
        self.quiet = self._empty(recipe.quiet_pool)
        for pool in (self.busy, self.quiet):
            self._refill(pool)

    def take(self, progress: float) -> Taken:
        """Draws a batch, some of it disturbed.

        Args:
            progress: 0..1 over the training; it decides how much of what is not whole is among the drawings.
        """
        recipe, random = self.recipe, self.random
        self._weigh(progress)
        busy_count = recipe.batch - recipe.quiet_batch
        resets = switches = disturbed = 0
        if recipe.pool == 0:
            self.busy = self._empty(busy_count)
            self._refill(self.busy)
            self._busy_taken = np.arange(busy_count)
        else:
            self._busy_taken = random.choice(recipe.pool, busy_count, replace=False)
            resets = round(recipe.reset * busy_count)
            switches = round(recipe.switch * busy_count)
            disturbed = resets + switches + round(recipe.scramble * busy_count)
            for number in self._busy_taken[:resets]:
                self.reset(self.busy, int(number))
            for number in self._busy_taken[resets : resets + switches]:
                self.switch(self.busy, int(number))
            for number in self._busy_taken[resets + switches : disturbed]:
                self.scramble(self.busy, int(number))
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
        away = np.zeros(len(batch.sample), np.bool_)
        for number in range(disturbed, disturbed + round(recipe.away * busy_count)):
            size = self.drawings.sizes[chosen[number]]
            away[batch.starts[number] + random.integers(size, size=random.integers(1, 3))] = True
        calm = np.arange(recipe.batch) >= busy_count
        chosen_states = states[batch.sample, batch.place]
        fresh = (chosen_states == self._seed).all(axis=1)
        return Taken(batch, chosen_states, settled, Circumstances(late, away, calm, fresh))

    def give_back(
        self, taken: Taken, states: States, rounds: NDArray[np.int64], right: NDArray[np.bool_]
    ) -> None:
        """Stores what became of the batch last taken.

        Args:
            taken: the batch.
            states: (N, C) float32.
            rounds: (B,) how many rounds each tissue lived.
            right: (B,) whether all its tiles were right at the end.
        """
        batch = taken.batch
        padded = np.zeros((len(batch.starts), *self.busy.states.shape[1:]), np.float32)
        padded[batch.sample, batch.place] = np.where(taken.given.away[:, None], self._seed, states)
        busy_count = len(self._busy_taken)
        self.busy.states[self._busy_taken] = padded[:busy_count]
        self.busy.age[self._busy_taken] += rounds[:busy_count]
        self.busy.age[self._busy_taken[~taken.asked[:busy_count]]] = 0
        self.quiet.states[self._quiet_taken] = padded[busy_count:]
        self.quiet.age[self._quiet_taken] += rounds[busy_count:]
        # Who was disturbed a moment ago may be wrong; who had time may not.
        had_time = self.busy.age[self._busy_taken] >= HAD_TIME
        seen = self.busy.drawing[self._busy_taken][had_time]
        self.failures[seen] += FORGETS * (~right[:busy_count][had_time] - self.failures[seen])

    def state(self) -> dict[str, Any]:
        """Everything that changes, as plain values and tensors for a checkpoint."""
        state: dict[str, Any] = {
            name: {field.name: torch.from_numpy(getattr(pool, field.name)) for field in fields(pool)}
            for name, pool in (("busy", self.busy), ("quiet", self.quiet))
        }
        return state | {"failures": torch.from_numpy(self.failures)}

    def restore(self, state: dict[str, Any]) -> None:
        """Takes back what `state` gave."""
        for name, pool in (("busy", self.busy), ("quiet", self.quiet)):
            for field in fields(pool):
                setattr(pool, field.name, state[name][field.name].cpu().numpy().copy())
        self.failures = state["failures"].cpu().numpy().copy()

    def _empty(self, count: int) -> Pool:
        shape = (count, int(self.drawings.sizes.max()), self.channels)
        zeros = np.zeros(count, np.int64)
        return Pool(zeros.copy(), np.zeros(shape, np.float32), zeros.copy(), zeros.copy())

    def _refill(self, pool: Pool) -> None:
        for number in range(len(pool.age)):
            self.reset(pool, number)

    def _weigh(self, progress: float) -> None:
        """Half-way between the drawings' weights and those times how often they fail, or as `hard` says."""
        least, (begin, end) = 0.05, self.recipe.ramp
        grown = np.clip((progress - begin) / max(end - begin, 1e-9), least, 1)
        weights = self.curriculum.weights * np.where(self.curriculum.whole, 1, grown)
        failing = weights * (self.failures + 1e-3)
        self._chances = (1 - self.recipe.hard) * weights / weights.sum()
        self._chances += self.recipe.hard * failing / failing.sum()

    def _pick(self, among: NDArray[np.int64]) -> int:
        upto = np.cumsum(self._chances[among])
        return int(among[min(np.searchsorted(upto, self.random.random() * upto[-1]), len(among) - 1)])

    def pick_whole(self, count: int, drawn: bool = False) -> NDArray[np.int64]:
        """(count,) drawings of a class without damage, at any size or those of the files only."""
        among = self._drawn if drawn else self._whole
        return np.array([self._pick(among) for _ in range(count)], np.int64)

    def pick_other(self, drawing: int) -> int:
        """Another drawing of its scale; the same where there is none."""
        others = self._same_scale[self.drawings.groups[drawing]]
        others = others[others != drawing]
        return self._pick(others) if len(others) else drawing

    def any_states(self, count: int) -> States:
        """(count, C) states of any tiles of the busy pool, which know nothing of each other."""
        tissues = self.random.integers(len(self.busy.drawing), size=count)
        return self.busy.states[
            tissues, self.random.integers(self.drawings.sizes[self.busy.drawing[tissues]])
        ]

    def scramble(self, pool: Pool, number: int) -> None:
        """Gives every tile of a tissue the state of any other."""
        size = self.drawings.sizes[pool.drawing[number]]
        pool.states[number, :size] = self.any_states(size)
        pool.age[number] = 0

    def put(self, drawing: int, states: States) -> None:
        """Into any place of the busy pool, as one that had time.

        Args:
            drawing: which.
            states: (its cells, C).
        """
        number = int(self.random.integers(len(self.busy.age)))
        self.busy.drawing[number] = drawing
        self.busy.states[number] = 0.0
        self.busy.states[number, : len(states)] = states
        self.busy.age[number] = HAD_TIME

    def reset(self, pool: Pool, number: int) -> None:
        """Puts down any drawing anew, every tile in its seed state."""
        among = self._everything
        if pool is self.quiet and self.random.random() < QUIET_DRAWN:
            among = self._drawn
        drawing = self._pick(among)
        pool.drawing[number] = drawing
        pool.states[number] = 0.0
        pool.states[number, : self.drawings.sizes[drawing], 0] = 1.0
        pool.age[number] = 0
        pool.life[number] = self.random.integers(*self.recipe.quiet_rounds)

    def switch(self, pool: Pool, number: int) -> None:
        """Rebuilds a tissue into another drawing of its scale; tiles that stay keep their state."""
        old = int(pool.drawing[number])
        new = self.pick_other(old)
        if new == old:
            return self.reset(pool, number)
        stays = self.drawings.overlap(old, new, self.random)
        before = pool.states[number].copy()
        pool.drawing[number] = new
        pool.states[number] = 0.0
        pool.states[number, : len(stays), 0] = 1.0
        kept = np.flatnonzero(stays >= 0)
        pool.states[number, kept] = before[stays[kept]]
        pool.age[number] = 0
        return None
