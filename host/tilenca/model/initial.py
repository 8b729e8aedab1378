"""The weights that training begins with. No torch here."""

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Dimensions


def initial_arrays(
    dimensions: Dimensions, random: np.random.Generator, zero_last: bool = True
) -> dict[str, NDArray[np.float32]]:
    """Glorot-uniform weights and zero biases; the last layer zero, so that an untrained tile does nothing."""
    arrays = {}
    for name, shape in dimensions.shapes().items():
        limit = 0.0 if name.startswith("b") or (name == "w3" and zero_last) else (6 / sum(shape)) ** 0.5
        arrays[name] = (limit * random.uniform(-1, 1, shape)).astype(np.float32)
    return arrays
