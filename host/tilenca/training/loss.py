"""The loss of a batch: the error of the tiles' scores, and a penalty for changes after convergence.

A tile's last channels are its scores, one per class; it shows the class with the largest score. The loss has
two terms:

- the squared error of the scores. The score of the drawing's class should be 1, all others 0;
- a stability penalty: in a grid that has converged, a tile that is right should keep its whole state. A tile
  that is wrong there pays no penalty, because it must stay free to change.
"""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from tilenca.shapes.batch import NO_CLASS


@dataclass(frozen=True)
class Goal:
    """The wanted states at the end of a batch's rollouts.

    Attributes:
        classes: K, the number of classes.
        target: (N,) int64, the class of each cell's drawing.
        counted: (N,) bool, cells whose scores count: their grid is complete and was so from the beginning.
        converged: (N,) bool, cells of grids that should not change any more.
    """

    classes: int
    target: Tensor
    counted: Tensor
    converged: Tensor


def scores_of(states: Tensor, classes: int) -> Tensor:
    """The scores of each cell: its last channels.

    Args:
        states: (N, C) float32, in units of the seed state.
        classes: K, the number of classes.

    Returns:
        (N, K) float32.
    """
    return states[:, -classes:]


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
    loss = (error * goal.counted).mean()
    if stability_penalty > 0:
        stable = goal.converged & (scores.argmax(dim=1) == goal.target)
        loss = loss + stability_penalty * ((end - start).square().sum(dim=1) * stable).mean()
    return loss
