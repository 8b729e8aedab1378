"""The training loop: draw tissues, let them live for some rounds, and pull every cell towards its class.

Reads top to bottom: `Trainer.step` is one optimiser step. Everything random comes from one numpy generator,
whose state is part of a checkpoint, so a resumed run continues to the very bytes of an uninterrupted one.
"""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from tilenca.base.errors import TilencaError
from tilenca.model.file import Dimensions, Model
from tilenca.model.quantise import quantise
from tilenca.shapes.batch import Batch
from tilenca.training.checkpoint import read_checkpoint, write_checkpoint
from tilenca.training.curriculum import Curriculum
from tilenca.training.network import TileNet, initial_arrays
from tilenca.training.pool import Pools
from tilenca.training.pool_refresh import live_ahead, put_what_is_stuck
from tilenca.training.recipes import Recipe
from tilenca.training.rollout import live
from tilenca.training.update_schedule import draw_schedule

TILES_PER_LIFE, LONGEST_LIFE = 16, 2.0
HISTORY_ROWS, HISTORY_EVERY = 200, 100  # so many rows at least, one for so many iterations at most


@dataclass(frozen=True)
class Config:
    """Everything that decides the trained weights."""

    recipe: Recipe
    dimensions: Dimensions
    seed: int
    labels: tuple[str, ...]
    sources: tuple[dict[str, str], ...]

    def as_json(self) -> dict[str, Any]:
        """Plain values, as JSON reads them back; without what does not touch the weights."""
        recipe = {key: list(v) if isinstance(v, tuple) else v for key, v in asdict(self.recipe).items()}
        del recipe["validation_runs"]
        return {
            "recipe": recipe,
            "dimensions": asdict(self.dimensions),
            "seed": self.seed,
            "labels": list(self.labels),
            "sources": list(self.sources),
        }


@dataclass(frozen=True)
class Trained:
    """What a training run has brought.

    Attributes:
        config: of the run.
        weights: those to keep, float32 by name, as `Model.floats` wants them.
        kept: the iteration they are of.
        iteration: how many it took.
        ended: whether before the last one, since all targets held.
        history: (iteration, loss, agreement), means since the row before.
        checks: (iteration, shortfall, smallest share by kind of question) of the short measurements.
        done: whether there is nothing left to train.
    """

    config: Config
    weights: dict[str, NDArray[np.float32]]
    kept: int
    iteration: int
    ended: bool
    history: list[tuple[int, float, float]]
    checks: list[tuple[int, float, dict[str, float]]]
    done: bool


@dataclass(frozen=True)
class StepReport:
    """What one optimiser step saw: mean squared error per cell, share of samples with every cell right."""

    iteration: int
    loss: float
    agreement: float


class Trainer:
    """A training run between two optimiser steps.

    Args:
        config: what to train.
        curriculum: what to look at; must be made of the task that `config` names.
        device: where the tensors live.
    """

    def __init__(self, config: Config, curriculum: Curriculum, device: torch.device) -> None:
        self.config = config
        self.drawings = curriculum.drawings
        self.device = device
        self.random = np.random.default_rng(config.seed)
        self.net = TileNet(
            config.dimensions, config.recipe.bounded, initial_arrays(config.dimensions, self.random)
        ).to(device)
        # What is kept in the end: the mean of the last thousand or so weights, far steadier than any of them.
        self.average = {name: value.detach().clone() for name, value in self.net.named_parameters()}
        self.optimizer = torch.optim.Adam(self.net.parameters(), lr=config.recipe.learning_rate)
        self.pools = Pools(config.recipe, curriculum, config.dimensions.channels, self.random)
        self.iteration = 0
        self.ended = False  # before the last iteration, since all targets held
        self.history: list[tuple[int, float, float]] = []  # iteration, and means since the row before
        self.checks: list[tuple[int, float, dict[str, float]]] = []  # iteration, shortfall, shares right
        self._since: list[tuple[float, float]] = []
        # Of the measured means that which fell short least: iteration, by how much, weights.
        self._best: tuple[int, float, dict[str, Tensor]] | None = None

    @property
    def done(self) -> bool:
        """Whether there is nothing left to train."""
        return self.ended or self.iteration >= self.config.recipe.iterations

    def recent(self) -> tuple[float, float]:
        """Mean loss and agreement of the last iterations, for the eye."""
        if not self._since:
            return self.history[-1][1:] if self.history else (math.nan, math.nan)
        losses, agreements = zip(*self._since, strict=True)
        return sum(losses) / len(losses), sum(agreements) / len(agreements)

    def step(self) -> StepReport:
        """One optimiser step.

        Raises:
            TilencaError: the loss is not a number any more.
        """
        recipe = self.config.recipe
        taken = self.pools.take(self.iteration / recipe.iterations)
        batch = taken.batch
        lives = self._lives(batch)
        schedule = draw_schedule(recipe, batch, lives, self.random, taken.given)

        start = torch.from_numpy(taken.states).to(self.device)
        end = live(self.net, start * self.net.units, schedule) / self.net.units
        target = torch.from_numpy(batch.target).to(self.device)
        scores = end[:, -len(self.config.labels) :]
        wanted = torch.nn.functional.one_hot(target, scores.shape[1]).to(scores.dtype)
        counts = torch.from_numpy(taken.asked[batch.sample]).to(self.device)
        loss = ((scores - wanted).square().sum(dim=1) * counts).mean()
        if recipe.quiet_penalty > 0:
            # Only where all is well: a settled wrong answer must stay free to change.
            still = torch.from_numpy(taken.settled[batch.sample]).to(self.device)
            still &= scores.argmax(dim=1) == target
            loss = loss + recipe.quiet_penalty * ((end - start).square().sum(dim=1) * still).mean()

        self._descend(loss)
        right = _all_right(scores, target, batch)
        self.pools.give_back(taken, end.detach().cpu().numpy(), lives, right)
        self.iteration += 1
        if recipe.ahead_every and self.iteration % recipe.ahead_every == 0:
            self._live_ahead()
        report = StepReport(self.iteration, loss.item(), float(right.mean()))
        self._since.append((report.loss, report.agreement))
        if self.iteration % max(1, min(HISTORY_EVERY, recipe.iterations // HISTORY_ROWS)) == 0:
            self.history.append((self.iteration, *self.recent()))
            self._since.clear()
        return report

    def _lives(self, batch: Batch) -> NDArray[np.int64]:
        """Rounds that each sample lives: drawn from the recipe's range, more where the sample is large."""
        least, most = self.config.recipe.rounds
        rounds = int(self.random.integers(least, most + 1))
        tiles = np.diff(np.append(batch.starts, len(batch.sample)))
        return np.round(rounds * np.clip(tiles / TILES_PER_LIFE, 1, LONGEST_LIFE)).astype(np.int64)

    def _descend(self, loss: Tensor) -> None:
        recipe = self.config.recipe
        if not math.isfinite(loss.item()):
            raise TilencaError(
                f"the loss is {loss.item()} at iteration {self.iteration + 1}: training diverged; "
                "try another --seed, or a recipe with a lower learning rate"
            )
        if recipe.cosine:
            fall = 0.5 * (1 - math.cos(math.pi * self.iteration / recipe.iterations))
            for group in self.optimizer.param_groups:
                group["lr"] = recipe.learning_rate * (1 - recipe.cosine * fall)
        self.optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        if recipe.clip_norm > 0:
            torch.nn.utils.clip_grad_norm_(self.net.parameters(), recipe.clip_norm)
        self.optimizer.step()
        if recipe.bounded:
            self.net.project()
        keep = min(recipe.average, self.iteration / (self.iteration + 10))
        with torch.no_grad():
            for name, value in self.net.named_parameters():
                self.average[name].lerp_(value, 1 - keep)

    def _live_ahead(self) -> None:
        model, _ = model_of(self.now(), {})
        recipe = self.config.recipe
        live_ahead(model, self.pools.quiet, self.drawings, recipe.ahead, self.random)
        put_what_is_stuck(model, self.pools, recipe.trials, self.random)

    def now(self) -> Trained:
        """What it has come to."""
        return self._trained(self.iteration, self.average)

    def best(self) -> Trained:
        """What was measured best; what it has come to where nothing was measured."""
        if self._best is None:
            return self.now()
        iteration, _, weights = self._best
        return self._trained(iteration, weights)

    def measured(self, shortfall: float, shares: dict[str, float]) -> None:
        """Notes what a measurement of `now()` found."""
        self.checks.append((self.iteration, shortfall, shares))
        if self._best is None or shortfall <= self._best[1]:
            weights = {name: value.clone() for name, value in self.average.items()}
            self._best = (self.iteration, shortfall, weights)

    def _trained(self, kept: int, tensors: dict[str, Tensor]) -> Trained:
        weights = {name: value.cpu().numpy().copy() for name, value in tensors.items()}
        return Trained(
            self.config,
            weights,
            kept,
            self.iteration,
            self.ended,
            self.history,
            self.checks,
            self.done,
        )

    def save(self, path: Path) -> None:
        """Writes a checkpoint, see `write_checkpoint`."""
        state = {
            "iteration": self.iteration,
            "random": self.random.bit_generator.state,
            "ended": self.ended,
            "done": self.done,
            "net": self.net.state_dict(),
            "average": self.average,
            "best": self._best,
            "optimizer": self.optimizer.state_dict(),
            "pools": self.pools.state(),
            "history": self.history,
            "since": self._since,
            "checks": self.checks,
        }
        write_checkpoint(path, self.config.as_json(), state)

    def load(self, path: Path) -> None:
        """Continues where a checkpoint was written, see `read_checkpoint`."""
        state = read_checkpoint(path, self.config.as_json(), self.device)
        self.net.load_state_dict(state["net"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.pools.restore(state["pools"])
        self.random.bit_generator.state = state["random"]
        self.history, self._since, self.checks = (
            [tuple(row) for row in state[rows]] for rows in ("history", "since", "checks")
        )
        self.average, self._best = state["average"], state["best"]
        self.iteration, self.ended = state["iteration"], state["ended"]


def trained_at(path: Path, config: Config) -> Trained:
    """What a checkpoint holds for the world, without what only training needs.

    Raises:
        UsageError: see `read_checkpoint`.
    """
    state = read_checkpoint(path, config.as_json(), torch.device("cpu"))
    kept, _, tensors = state["best"] or (state["iteration"], None, state["average"])
    weights = {name: value.numpy() for name, value in tensors.items()}
    history, checks = ([tuple(row) for row in state[rows]] for rows in ("history", "checks"))
    return Trained(config, weights, kept, state["iteration"], state["ended"], history, checks, state["done"])


def model_of(trained: Trained, made: dict[str, object]) -> tuple[Model, int]:
    """The integer model of what was trained, and how many weights had to be cut."""
    return quantise(trained.config.dimensions, trained.config.labels, trained.weights, made)


def _all_right(scores: Tensor, target: Tensor, batch: Batch) -> NDArray[np.bool_]:
    wrong = (scores.detach().argmax(dim=1) != target).cpu().numpy()
    right: NDArray[np.bool_] = np.add.reduceat(wrong, batch.starts, dtype=np.int64) == 0
    return right
