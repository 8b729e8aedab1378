"""What a tile says is missing: the last step after an update, for models with directions.

Four channels right before the scores of the classes are the scores of the directions N, E, S, W. A tile says
that a tile is missing on the side with the greatest of them, the first one among equals, if that is above one
half; else it says nothing. It goes by the message (docs/PROTOCOL.md section 4), so that whoever reads a
tile's state knows what it says. Twin of `missing_side` in firmware/include/core/network.h.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import SIDES
from tilenca.model.file import Model
from tilenca.model.widen import Arrays, placed
from tilenca.protocol.constants import MISSING

NOWHERE = -1
THRESHOLD = 0.5  # of a score; MISSING in the units of a message


def missing_sides(states: NDArray[np.int16], classes: int) -> NDArray[Any]:
    """(N,) the side, 0 to 3, on which each tile says that one is missing; `NOWHERE` for none.

    Args:
        states: (N, C) stored states.
        classes: the number of classes.
    """
    scores = (states[:, -classes - len(SIDES) : -classes].astype(np.int32) + 64) >> 7
    return np.where(scores.max(axis=1) > MISSING, scores.argmax(axis=1), NOWHERE)


def with_directions(model: Model) -> Model:
    """The same model with four more channels for the directions; all of their weights are zero.

    It shows the same classes and says of no side that a tile is missing.
    """
    old = model.dimensions
    size = replace(old, channels=old.channels + len(SIDES), directions=len(SIDES))
    kept = np.delete(np.arange(size.channels), np.arange(len(SIDES)) + old.channels - len(model.labels))

    def wider(arrays: Arrays) -> Arrays:
        none = {name: np.zeros(shape, arrays[name].dtype) for name, shape in size.shapes().items()}
        return placed(arrays, kept, none)

    return Model(model.labels, size, wider(model.integer), wider(model.floats), model.metadata)
