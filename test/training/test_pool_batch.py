"""Batches from the pools."""

import numpy as np

from tilenca.base import paths
from tilenca.shapes.batch import load_drawings
from tilenca.training.pool_batch import Taken
from tilenca.training.update_schedule import Circumstances


def test_grids_that_were_switched_on_late_or_lack_a_tile_do_not_count() -> None:
    batch = load_drawings([paths.DEFAULT_SHAPES]).batch(np.array([1, 4, 7]))
    cells = len(batch.sample)
    away = np.zeros(cells, np.bool_)
    away[batch.starts[2] + 1] = True
    nothing = np.zeros(cells, np.bool_)
    given = Circumstances(np.array([True, False, False]), away, np.zeros(3, np.bool_), nothing)
    states = np.zeros((cells, 21), np.float32)
    taken = Taken(
        np.array([5, 3]), np.array([9]), batch, states, np.zeros(3, np.bool_), given, np.array([1, 4, 7])
    )
    assert taken.counted.tolist() == [False, True, False]
