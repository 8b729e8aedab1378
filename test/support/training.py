"""What tests of training begin with."""

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch
from tilenca.training.update_schedule import Circumstances


def usual(batch: Batch, **given: NDArray[np.bool_]) -> Circumstances:
    """All tiles on, running and known, but for what is given."""
    per_sample, per_cell = (np.zeros(len(what), np.bool_) for what in (batch.starts, batch.sample))
    nothing = {"staggered": per_sample, "away": per_cell, "lossless": per_sample, "fresh": per_cell}
    return Circumstances(**(nothing | given))
