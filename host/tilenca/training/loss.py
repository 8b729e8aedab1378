"""The loss of a batch: the error of the tiles' scores, and a penalty for changes after convergence.

A tile's last channels are its scores, one per class; it shows the class with the largest score. The loss has
two terms:

- the squared error of the scores. The score of the drawing's class should be 1, all others 0. Where a
  network has directions, their four scores come before those of the classes: that of the side on which a
  tile is missing should be 1;
- a stability penalty: in a grid that has converged, a tile that is right should keep its whole state. A tile
  that is wrong there pays no penalty, because it must stay free to change.
"""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from tilenca.base.sides import SIDES
from tilenca.model.directions import NOWHERE, THRESHOLD
from tilenca.shapes.batch import NO_CLASS

BESIDE = 5.0  # weight of a tile beside a gap, of which there are one or two in twenty, against the others


@dataclass(frozen=True)
class Goal:
    """The wanted states at the end of a batch's rollouts.

    Attributes:
        classes: K, the number of classes.
        target: (N,) int64, the class of each cell's drawing.
        counted: (N,) bool, cells whose scores count: their grid is complete and was so from the beginning.
        converged: (N,) bool, cells of grids that should not change any more.
        gaps: what the scores of the directions should be; None: there are none.
    """

    classes: int
    target: Tensor
    counted: Tensor
    converged: Tensor
    gaps: "GapGoal | None" = None


@dataclass(frozen=True)
class GapGoal:
    """Where tiles are missing.

    Attributes:
        missing: (N, 4) float32, 1 for the sides N, E, S, W of a cell on which a tile is missing.
        told: (N,) bool, cells of grids of which that is known.
        weight: of the error of these scores, beside that of the classes'.
    """

    missing: Tensor
    told: Tensor
    weight: float

    def error(self, scores: Tensor) -> Tensor:
        """(N,) the weighted squared error of (N, 4) scores, more where a tile is missing."""
        weight = self.weight * self.told * torch.where(self.missing.any(dim=1), BESIDE, 1.0)
        return weight * (scores - self.missing).square().sum(dim=1)

    def right(self, scores: Tensor) -> Tensor:
        """(N,) bool, whether a tile says what it should, see `tilenca.model.directions`."""
        most, side = scores.max(dim=1)
        says = torch.where(most > THRESHOLD, side, NOWHERE)
        should = torch.where(self.missing.any(dim=1), self.missing.argmax(dim=1), NOWHERE)
        return (says == should) | ~self.told


def scores_of(states: Tensor, classes: int) -> Tensor:
    """The scores of each cell: its last channels.

    Args:
        states: (N, C) float32, in units of the seed state.
        classes: K, the number of classes.

    Returns:
        (N, K) float32.
    """
    return states[:, -classes:]


def directions_of(states: Tensor, classes: int) -> Tensor:
    """(N, 4) the scores of the directions of each cell, which come before those of the classes."""
    return states[:, -classes - len(SIDES) : -classes]


def agreed_targets(scores: Tensor, target: Tensor, starts: NDArray[np.int64]) -> Tensor:
    """The targets, with the class that the tiles of an unlabelled grid favour together in place of none.

    Args:
        scores: (N, K) float32.
        target: (N,) int64, `NO_CLASS` in unlabelled grids.
        starts: (B,) int64, the first cell of each grid.

    Returns:
        (N,) int64.
    """
    if not bool((target == NO_CLASS).any()):
        return target
    sums = np.add.reduceat(scores.detach().cpu().numpy(), starts, axis=0)
    favoured = np.repeat(sums.argmax(axis=1), np.diff(np.append(starts, len(target))))
    return torch.where(target == NO_CLASS, torch.from_numpy(favoured).to(target.device), target)


def loss_of(start: Tensor, end: Tensor, goal: Goal, stability_penalty: float, limit: float = 0.0) -> Tensor:
    """The loss of a batch of rollouts.

    Args:
        start: (N, C) float32, states before the rollouts, in units of the seed state.
        end: (N, C) float32, states after them.
        goal: what they should be.
        stability_penalty: weight of the second term; 0: there is none.
        limit: of what one cell adds, which it approaches as it gets worse: cells that nothing can mend do not
            pull at those that are right (Geman and McClure, 1987); 0: none.

    Returns:
        () float32, the mean over the cells.
    """
    scores = scores_of(end, goal.classes)
    wanted = torch.nn.functional.one_hot(goal.target, goal.classes).to(scores.dtype)
    error = (scores - wanted).square().sum(dim=1)
    if limit > 0:
        error = error / (1 + error / limit)
    if goal.gaps is not None:
        error = error + goal.gaps.error(directions_of(end, goal.classes))
    loss = (error * goal.counted).mean()
    if stability_penalty > 0:
        stable = goal.converged & (scores.argmax(dim=1) == goal.target)
        if goal.gaps is not None:
            stable = stable & goal.gaps.right(directions_of(end, goal.classes))
        loss = loss + stability_penalty * ((end - start).square().sum(dim=1) * stable).mean()
    return loss
