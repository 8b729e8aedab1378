"""The integer network in numpy, written to be read: what all others must equal."""

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model


def reference(model: Model, states: NDArray[np.int16], inputs: NDArray[np.int8]) -> NDArray[np.int64]:
    """One update in int64, which nothing here can overflow."""
    wide = {name: array.astype(np.int64) for name, array in model.integer.items()}
    hidden = np.clip((inputs.astype(np.int64) @ wide["w1"].T + wide["b1"] + 32) >> 6, 0, 127)
    hidden = np.clip((hidden @ wide["w2"].T + wide["b2"] + 32) >> 6, 0, 127)
    new_states: NDArray[np.int64] = np.clip(states + hidden @ wide["w3"].T + wide["b3"], -16256, 16256)
    return new_states
