"""A batch of grids that were taken from the pools, with what happens to them during the rollout."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch
from tilenca.training.update_schedule import Circumstances

States = NDArray[np.float32]
Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Taken:
    """A batch of B grids from the pools.

    Attributes:
        perturbed: which grids of the perturbed pool come first in the batch.
        undisturbed: which grids of the undisturbed pool come after them.
        batch: their cells.
        states: (N, C) float32.
        converged: (B,) bool, undisturbed for so long that nothing should change any more.
        given: their circumstances during the rollout; tiles that are away are back in the seed state when the
        grid is taken again, and the undisturbed pool loses no messages.
        drawing: (B,) the drawing of each grid.
    """

    perturbed: Numbers
    undisturbed: Numbers
    batch: Batch
    states: States
    converged: NDArray[np.bool_]
    given: Circumstances
    drawing: Numbers

    @property
    def counted(self) -> NDArray[np.bool_]:
        """(B,) whether a grid's result counts: all of its tiles are there, and were from the beginning."""
        return ~(self.given.staggered | np.logical_or.reduceat(self.given.away, self.batch.starts))
