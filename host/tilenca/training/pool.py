"""Grids whose rollouts go on from one iteration to the next: the perturbed and the undisturbed pool.

One iteration covers only some ten updates of a grid. With a pool these are *any* ten of a long rollout: a
grid may have just been switched on, may have been rebuilt into another drawing (tiles that stay keep their
state), or may have converged long ago.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import Shape
from tilenca.training.checkpoint import array_like
from tilenca.training.curriculum import DRAWN, Curriculum
from tilenca.training.pool_batch import Numbers, States, Taken
from tilenca.training.recipe import Recipe
from tilenca.training.update_schedule import Circumstances

FAILURE_EMA = 0.1  # weight of the newest result in a drawing's share of failures
UNDISTURBED_DRAWN = 0.5  # share of the files' own drawings in the undisturbed pool
WENT_WRONG = 0.3  # most of an undisturbed batch that are grids which were wrong when they were last seen
SAME_SCALE = 2, 3  # rows and columns by which drawings may differ that are rebuilt into each other
LASTING = 0.5  # the share of rebuilt grids whose new drawing is of the files, or a stretched one
PATIENCE = 1000  # ticks for which a grid that does not agree is left alone
CONVERGED_AFTER = 40  # ticks without a disturbance after which a wrong tile counts as a failure


@dataclass
class Pool:
    """Grids, with the time since each was disturbed last.

    Attributes:
        drawing: (P,) int64, the drawing of each grid.
        states: (P, M, C) float32, states of its cells, unused places zero.
        age: (P,) int64, ticks since the last disturbance.
        lifetime: (P,) int64, ticks after which an undisturbed grid starts anew.
        wrong: (P,) bool, grids that should have converged and had a wrong tile when they were last seen.
    """

    drawing: Numbers
    states: States
    age: Numbers
    lifetime: Numbers
    wrong: NDArray[np.bool_]


class Pools:
    """The perturbed and the undisturbed pool of one training run; without pools every sample is fresh."""

    def __init__(
        self, recipe: Recipe, curriculum: Curriculum, channels: int, random: np.random.Generator
    ) -> None:
        self.recipe = recipe
        self.curriculum = curriculum
        self.random = random
        self.channels = channels
        self._seed = np.eye(1, channels, dtype=np.float32)
        # The recent share of failures of each record, 0..1; a drawing counts as failing until it is measured.
        self.failures = np.ones(curriculum.records)
        self._whole = np.flatnonzero(curriculum.whole)
        self._drawn = np.flatnonzero(curriculum.kinds == DRAWN)
        self._lasting = ~curriculum.renewable
        self._weigh(0.0)
        self.perturbed = self._empty(recipe.perturbed_pool)
        self.undisturbed = self._empty(recipe.undisturbed_pool)
        for pool in (self.perturbed, self.undisturbed):
            self._refill(pool)

    @property
    def drawings(self) -> Drawings:
        """All drawings, those that are renewed as they are now."""
        return self.curriculum.drawings

    def renew(self) -> None:
        """Replaces some of the drawings that no grid has by new ones."""
        renewable = np.flatnonzero(~self._lasting)
        idle = np.setdiff1d(renewable, np.concatenate((self.perturbed.drawing, self.undisturbed.drawing)))
        some = self.random.permutation(idle)[: round(self.recipe.renewed * len(renewable))]
        self.curriculum = self.curriculum.renewed(some, self.random)

    def take(self, progress: float) -> Taken:
        """Draws a batch, and disturbs some of it.

        Args:
            progress: 0..1 over the training; it decides the share of drawings that are renewed.
        """
        recipe, random = self.recipe, self.random
        self._weigh(progress)
        count = recipe.batch - recipe.undisturbed_batch
        perturbed, resets, disturbed = self._take_perturbed(count)
        undisturbed = self._take_undisturbed()
        chosen = np.concatenate((self.perturbed.drawing[perturbed], self.undisturbed.drawing[undisturbed]))
        states = np.concatenate((self.perturbed.states[perturbed], self.undisturbed.states[undisturbed]))
        batch = self.drawings.batch(chosen)
        converged = np.zeros(recipe.batch, np.bool_)
        converged[count:] = self.undisturbed.age[undisturbed] >= recipe.undisturbed_ticks[0] // 2
        staggered = np.zeros(recipe.batch, np.bool_)
        staggered[:resets] = random.random(resets) < recipe.staggered_start
        away = np.zeros(len(batch.sample), np.bool_)
        for number in range(disturbed, disturbed + round(recipe.away * count)):
            size = self.drawings.sizes[chosen[number]]
            away[batch.starts[number] + random.integers(size, size=random.integers(1, 3))] = True
        lossless = np.arange(recipe.batch) >= count
        chosen_states = states[batch.sample, batch.place]
        fresh = (chosen_states == self._seed).all(axis=1)
        given = Circumstances(staggered, away, lossless, fresh)
        return Taken(perturbed, undisturbed, batch, chosen_states, converged, given, chosen)

    def _take_perturbed(self, count: int) -> tuple[Numbers, int, int]:
        """Draws grids of the perturbed pool: up to which one they are reset, and up to which disturbed."""
        recipe = self.recipe
        if recipe.perturbed_pool == 0:
            self.perturbed = self._empty(count)
            return self._refill(self.perturbed), 0, 0
        taken = self.random.choice(recipe.perturbed_pool, count, replace=False)
        # Grids that do not agree go on until they do; others are disturbed.
        stays = self.perturbed.wrong[taken] & (self.perturbed.age[taken] < PATIENCE)
        taken = np.concatenate((taken[~stays], taken[stays]))
        resets = round(recipe.reset * count)
        switched = resets + round(recipe.switch * count)
        disturbed = switched + round(recipe.state_shuffle * count)
        *parts, _ = np.split(taken, (resets, switched, disturbed))
        for number in parts[1]:
            if recipe.settled * recipe.undisturbed_pool > 0 and self.random.random() < recipe.settled:
                self._copy_undisturbed(int(number))
        for numbers, disturb in zip(parts, (self.reset, self.switch, self.shuffle_states), strict=True):
            for number in numbers:
                disturb(self.perturbed, int(number))
        return taken, resets, disturbed

    def _copy_undisturbed(self, number: int) -> None:
        """Puts any grid of the undisturbed pool into a place of the perturbed one."""
        other = int(self.random.integers(len(self.undisturbed.age)))
        self.perturbed.drawing[number] = self.undisturbed.drawing[other]
        self.perturbed.states[number] = self.undisturbed.states[other]

    def _take_undisturbed(self) -> Numbers:
        """Draws grids of the undisturbed pool, some of those that went wrong; old ones start anew."""
        recipe = self.recipe
        every = self.random.permutation(recipe.undisturbed_pool)
        wrong = every[self.undisturbed.wrong[every]][: round(WENT_WRONG * recipe.undisturbed_batch)]
        others = np.setdiff1d(every, wrong, assume_unique=True)
        rest = self.random.choice(others, recipe.undisturbed_batch - len(wrong), replace=False)
        taken = np.concatenate((wrong, rest))
        for number in taken:
            if self.undisturbed.age[number] >= self.undisturbed.lifetime[number]:
                self.reset(self.undisturbed, int(number))
        return taken

    def give_back(self, taken: Taken, states: States, ticks: Numbers, right: NDArray[np.bool_]) -> None:
        """Stores the end of a batch's rollouts.

        Args:
            taken: the batch.
            states: (N, C) float32.
            ticks: (B,) ticks that each grid ran.
            right: (B,) whether all its tiles were right at the end.
        """
        batch, count = taken.batch, len(taken.perturbed)
        padded = np.zeros((len(batch.starts), *self.perturbed.states.shape[1:]), np.float32)
        padded[batch.sample, batch.place] = np.where(taken.given.away[:, None], self._seed, states)
        self.perturbed.states[taken.perturbed] = padded[:count]
        self.perturbed.age[taken.perturbed] += ticks[:count]
        self.perturbed.age[taken.perturbed[~taken.counted[:count]]] = 0
        self.undisturbed.states[taken.undisturbed] = padded[count:]
        self.undisturbed.age[taken.undisturbed] += ticks[count:]
        # A grid that was disturbed a moment ago may be wrong; converged grids must be right.
        converged = self.perturbed.age[taken.perturbed] >= CONVERGED_AFTER
        self.perturbed.wrong[taken.perturbed] = converged & ~right[:count]
        old = self.undisturbed.age[taken.undisturbed] >= CONVERGED_AFTER
        self.undisturbed.wrong[taken.undisturbed] = old & ~right[count:]
        seen = self.curriculum.failing[self.perturbed.drawing[taken.perturbed][converged]]
        records, record, times = np.unique(seen, return_inverse=True, return_counts=True)
        failed = np.bincount(record, ~right[:count][converged], len(records)) / times
        self.failures[records] += FAILURE_EMA * (failed - self.failures[records])

    def state(self) -> dict[str, Any]:
        """Everything that changes, as plain values and tensors for a checkpoint."""
        state: dict[str, Any] = {
            name: {field.name: torch.from_numpy(getattr(pool, field.name)) for field in fields(pool)}
            for name, pool in (("perturbed", self.perturbed), ("undisturbed", self.undisturbed))
        }
        renewable = np.array(self.drawings.shapes, object)[~self._lasting]
        renewed = [(shape.label, shape.rows, shape.name) for shape in renewable]
        return state | {"failures": torch.from_numpy(self.failures), "renewed": renewed}

    def restore(self, state: dict[str, Any]) -> None:
        """Continues with what `state` returned; any exception: it is of another form than this run's."""
        for name in ("perturbed", "undisturbed"):
            pool = getattr(self, name)
            for field in fields(Pool):
                own = getattr(pool, field.name)
                setattr(pool, field.name, array_like(state[name][field.name], own.dtype, own.shape[1:]))
        self.failures = array_like(state["failures"], self.failures.dtype, ())
        shapes = [Shape(*values) for values in state["renewed"]]
        self.curriculum = self.curriculum.with_drawings(np.flatnonzero(~self._lasting), shapes)

    def _empty(self, count: int) -> Pool:
        states = np.zeros((count, self.curriculum.most_tiles, self.channels), np.float32)
        drawing, age, lifetime = np.zeros((3, count), np.int64)
        return Pool(drawing, states, age, lifetime, np.zeros(count, np.bool_))

    def _refill(self, pool: Pool) -> Numbers:
        for number in range(len(pool.age)):
            self.reset(pool, number)
        return np.arange(len(pool.age))

    def _weigh(self, progress: float) -> None:
        """Sets each drawing's chance: a mixture of its weight and its weight times its share of failures."""
        least, (begin, end) = 0.05, self.recipe.ramp
        grown = np.clip((progress - begin) / max(end - begin, 1e-9), least, 1)
        weights = self.curriculum.weights * np.where(self._lasting, 1, grown)
        failing = weights * (self.failures[self.curriculum.failing] + 1e-3)
        share = self.recipe.failure_weighting
        self._chances = (1 - share) * weights / weights.sum() + share * failing / failing.sum()

    def _pick(self, among: NDArray[np.int64]) -> int:
        upto = np.cumsum(self._chances[among])
        return int(among[min(np.searchsorted(upto, self.random.random() * upto[-1]), len(among) - 1)])

    def pick_whole(self, count: int, drawn: bool = False) -> NDArray[np.int64]:
        """(count,) drawings of a class without damage, at any size or those of the files only."""
        return np.array([self._pick(self._drawn if drawn else self._whole) for _ in range(count)], np.int64)

    def pick_other(self, drawing: int) -> int:
        """Another drawing of about its size, often one that stays; the same where there is none.

        By the recipe's share of `one_tile` it is one with a tile less, or with the missing one back.
        """
        if self.recipe.one_tile and self.random.random() < self.recipe.one_tile:
            near_ones = self.curriculum.with_one_tile_changed(drawing)
            if len(near_ones):
                return int(self.random.choice(near_ones))
        extents = self.drawings.extents
        near = (np.abs(extents - extents[drawing]) <= SAME_SCALE).all(axis=1)
        near[drawing] = False
        if self.random.random() < LASTING and (near & self._lasting).any():
            near &= self._lasting
        return self._pick(np.flatnonzero(near)) if near.any() else drawing

    def any_states(self, count: int) -> States:
        """(count, C) states of any tiles of the perturbed pool, drawn independently of each other."""
        grids = self.random.integers(len(self.perturbed.drawing), size=count)
        return self.perturbed.states[
            grids, self.random.integers(self.drawings.sizes[self.perturbed.drawing[grids]])
        ]

    def shuffle_states(self, pool: Pool, number: int) -> None:
        """Gives every tile of a grid the state of any tile of the pool: it must recover from it."""
        size = self.drawings.sizes[pool.drawing[number]]
        pool.states[number, :size] = self.any_states(size)
        pool.age[number] = 0

    def put(self, drawing: int, states: States) -> None:
        """Puts a grid into any place of the perturbed pool, as one that should have converged.

        Args:
            drawing: its drawing.
            states: (its cells, C).
        """
        number = int(self.random.integers(len(self.perturbed.age)))
        self.perturbed.drawing[number] = drawing
        self.perturbed.states[number] = 0.0
        self.perturbed.states[number, : len(states)] = states
        self.perturbed.age[number] = CONVERGED_AFTER
        self.perturbed.wrong[number] = True

    def reset(self, pool: Pool, number: int) -> None:
        """Starts a grid anew with any drawing, every tile in its seed state."""
        among = np.arange(len(self.curriculum.kinds))
        if pool is self.undisturbed and self.random.random() < UNDISTURBED_DRAWN:
            among = self._drawn
        pool.drawing[number] = drawing = self._pick(among)
        pool.states[number] = 0.0
        pool.states[number, : self.drawings.sizes[drawing], 0] = 1.0
        pool.age[number] = 0
        pool.wrong[number] = False
        pool.lifetime[number] = self.random.integers(*self.recipe.undisturbed_ticks)

    def switch(self, pool: Pool, number: int) -> None:
        """Rebuilds a grid into another drawing of its scale; tiles that stay keep their state."""
        old = int(pool.drawing[number])
        new = self.pick_other(old)
        if new == old:
            self.reset(pool, number)
            return
        stays = self.drawings.overlap(old, new, self.random)
        before = pool.states[number].copy()
        pool.drawing[number] = new
        pool.states[number] = 0.0
        pool.states[number, : len(stays), 0] = 1.0
        kept = np.flatnonzero(stays >= 0)
        pool.states[number, kept] = before[stays[kept]]
        pool.age[number] = 0
