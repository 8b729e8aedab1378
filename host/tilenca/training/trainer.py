"""The training loop: draw grids, run short rollouts, and pull the state of every cell towards its class.

Read it from top to bottom: `Trainer.step` is one optimiser step. All random numbers come from one numpy
generator, whose state is part of a checkpoint, so a resumed run ends with the bytes of an uninterrupted one.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from tilenca.base.errors import TilencaError
from tilenca.model.file import Model
from tilenca.model.initial import initial_arrays
from tilenca.model.quantise import quantise
from tilenca.shapes.batch import Batch
from tilenca.training.checkpoint import damaged, read_checkpoint, write_checkpoint
from tilenca.training.config import Config
from tilenca.training.curriculum import Curriculum
from tilenca.training.loss import GapGoal, Goal, agreed_targets, directions_of, loss_of, scores_of
from tilenca.training.network import TileNet
from tilenca.training.pool import Pools
from tilenca.training.pool_batch import Taken
from tilenca.training.pool_refresh import mine_hard_examples, refresh_undisturbed
from tilenca.training.rollout import rollout
from tilenca.training.update_schedule import draw_schedule

TILES_PER_ROLLOUT, LONGEST_ROLLOUT = 16, 2.0
HISTORY_ROWS, HISTORY_EVERY = 200, 100  # least number of rows, and most iterations per row


@dataclass(frozen=True)
class Trained:
    """The result of a training run.

    Attributes:
        config: of the run.
        weights: the best ones, float32 by name, for `Model.floats`.
        best_iteration: the iteration of these weights.
        iteration: how many iterations were done.
        ended: whether it ended before the last iteration, since all targets held.
        history: (iteration, loss, agreement), means since the row before.
        checks: (iteration, shortfall, `least_shares`) of the short measurements.
        done: whether there is nothing left to train.
    """

    config: Config
    weights: dict[str, NDArray[np.float32]]
    best_iteration: int
    iteration: int
    ended: bool
    history: list[tuple[int, float, float]]
    checks: list[tuple[int, float, dict[str, float]]]
    done: bool


@dataclass(frozen=True)
class StepReport:
    """One optimiser step: mean squared error per cell, share of samples with every cell right."""

    iteration: int
    loss: float
    agreement: float


class Trainer:
    """A training run between two optimiser steps.

    Args:
        config: what to train.
        curriculum: the drawings; made of the task that `config` names.
        device: of the tensors.
    """

    def __init__(self, config: Config, curriculum: Curriculum, device: torch.device) -> None:
        self.config = config
        self.device = device
        self.random = np.random.default_rng(config.seed)
        self.net = TileNet(
            config.dimensions,
            config.recipe.quantisation_aware,
            initial_arrays(config.dimensions, self.random)
            if config.initial is None
            else config.initial.floats,
        ).to(device)
        # The EMA becomes the model: a mean of the last thousand or so weights, far steadier than each.
        self.ema = {name: value.detach().clone() for name, value in self.net.named_parameters()}
        self.optimizer = torch.optim.Adam(self.net.parameters(), lr=config.recipe.learning_rate)
        self.pools = Pools(config.recipe, curriculum, config.dimensions.channels, self.random)
        self.iteration = 0
        self.ended = False  # before the last iteration, since all targets held
        self.history: list[tuple[int, float, float]] = []  # iteration, and means since the row before
        self.checks: list[tuple[int, float, dict[str, float]]] = []  # iteration, shortfall, shares right
        self._since: list[tuple[float, float]] = []
        # The measured EMA with the least shortfall: iteration, shortfall, weights.
        self._best: tuple[int, float, dict[str, Tensor]] | None = None

    @property
    def done(self) -> bool:
        """Whether there is nothing left to train."""
        return self.ended or self.iteration >= self.config.recipe.iterations

    def recent(self) -> tuple[float, float]:
        """Mean loss and agreement of the last iterations, for display."""
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
        lengths = self._lengths(batch)
        schedule = draw_schedule(recipe, batch, lengths, self.random, taken.given)

        start = torch.from_numpy(taken.states).to(self.device)
        end = rollout(self.net, start * self.net.units, schedule) / self.net.units
        target, counted, converged = (
            torch.from_numpy(array).to(self.device)
            for array in (batch.target, taken.counted[batch.sample], taken.converged[batch.sample])
        )
        target = agreed_targets(scores_of(end, len(self.config.labels)), target, batch.starts)
        goal = Goal(len(self.config.labels), target, counted, converged, self._gaps(taken))
        limit = recipe.loss_limit if self.iteration >= recipe.limited_from * recipe.iterations else 0.0
        loss = loss_of(start, end, goal, recipe.stability_penalty, limit)

        self._descend(loss)
        right = _all_right(end, goal, batch)
        self.pools.give_back(taken, end.detach().cpu().numpy(), lengths, right)
        self.iteration += 1
        self._refresh_pools()
        report = StepReport(self.iteration, loss.item(), float(right.mean()))
        self._since.append((report.loss, report.agreement))
        if self.iteration % max(1, min(HISTORY_EVERY, recipe.iterations // HISTORY_ROWS)) == 0:
            self.history.append((self.iteration, *self.recent()))
            self._since.clear()
        return report

    def _gaps(self, taken: Taken) -> GapGoal | None:
        """Where tiles are missing, for a network that learns to say it."""
        if not (weight := self.config.recipe.directions):
            return None
        missing, told = self.pools.curriculum.missing(taken.drawing)
        sides = torch.from_numpy(missing.astype(np.float32)).to(self.device)
        return GapGoal(sides, torch.from_numpy(told).to(self.device), weight)

    def _lengths(self, batch: Batch) -> NDArray[np.int64]:
        """(B,) ticks of each rollout: drawn from the recipe's range, more where the sample is large."""
        least, most = self.config.recipe.ticks
        ticks = int(self.random.integers(least, most + 1))
        tiles = np.diff(np.append(batch.starts, len(batch.sample)))
        return np.round(ticks * np.clip(tiles / TILES_PER_ROLLOUT, 1, LONGEST_ROLLOUT)).astype(np.int64)

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
        if recipe.quantisation_aware:
            self.net.project()
        keep = min(recipe.ema_decay, self.iteration / (self.iteration + 10))
        with torch.no_grad():
            for name, value in self.net.named_parameters():
                self.ema[name].lerp_(value, 1 - keep)

    def _refresh_pools(self) -> None:
        """Long rollouts, hard examples and new drawings, now and then."""
        recipe, pools = self.config.recipe, self.pools
        refresh, mine = (n and self.iteration % n == 0 for n in (recipe.refresh_every, recipe.mine_every))
        if not (refresh or mine):
            return
        model, _ = model_of(self.now(), {})
        if mine:
            pools.renew()
        if refresh:
            refresh_undisturbed(model, pools.undisturbed, pools.drawings, recipe.refresh_steps, self.random)
        if mine:
            mine_hard_examples(model, pools, recipe.trials, self.random)

    def now(self) -> Trained:
        """The result so far."""
        return self._trained(self.iteration, self.ema)

    def best(self) -> Trained:
        """The best measured result; the result so far where nothing was measured."""
        if self._best is None:
            return self.now()
        iteration, _, weights = self._best
        return self._trained(iteration, weights)

    def measured(self, shortfall: float, shares: dict[str, float]) -> None:
        """Notes the result of a measurement of `now()`."""
        self.checks.append((self.iteration, shortfall, shares))
        if self._best is None or shortfall <= self._best[1]:
            weights = {name: value.clone() for name, value in self.ema.items()}
            self._best = (self.iteration, shortfall, weights)

    def _trained(self, best_iteration: int, tensors: dict[str, Tensor]) -> Trained:
        weights = {name: value.cpu().numpy().copy() for name, value in tensors.items()}
        return Trained(
            self.config,
            weights,
            best_iteration,
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
            "ema": self.ema,
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
        try:
            self.net.load_state_dict(state["net"])
            self.optimizer.load_state_dict(state["optimizer"])
            self.pools.restore(state["pools"])
            self.random.bit_generator.state = state["random"]
            self._since = [(float(loss), float(agreement)) for loss, agreement in state["since"]]
        except Exception as error:  # any exception of torch and numpy on values of another form
            raise damaged(path, type(error).__name__) from error
        self.history, self.checks = ([tuple(row) for row in state[rows]] for rows in ("history", "checks"))
        self.ema, self._best = state["ema"], state["best"]
        self.iteration, self.ended = state["iteration"], state["ended"]


def trained_at(path: Path, config: Config) -> Trained:
    """The result that a checkpoint holds, without the state that only training needs.

    Raises:
        UsageError: see `read_checkpoint`.
    """
    state = read_checkpoint(path, config.as_json(), torch.device("cpu"))
    best_iteration, _, tensors = state["best"] or (state["iteration"], None, state["ema"])
    weights = {name: value.numpy() for name, value in tensors.items()}
    history, checks = ([tuple(row) for row in state[rows]] for rows in ("history", "checks"))
    return Trained(
        config, weights, best_iteration, state["iteration"], state["ended"], history, checks, state["done"]
    )


def model_of(trained: Trained, metadata: dict[str, object]) -> tuple[Model, int]:
    """The integer model of a training, and how many weights had to be cut."""
    return quantise(trained.config.dimensions, trained.config.labels, trained.weights, metadata)


def _all_right(states: Tensor, goal: Goal, batch: Batch) -> NDArray[np.bool_]:
    """(B,) whether all tiles of a grid show its class and, where there are directions, say them right."""
    states = states.detach()
    fine = scores_of(states, goal.classes).argmax(dim=1) == goal.target
    if goal.gaps is not None:
        fine &= goal.gaps.right(directions_of(states, goal.classes))
    right: NDArray[np.bool_] = np.add.reduceat(~fine.cpu().numpy(), batch.starts, dtype=np.int64) == 0
    return right
