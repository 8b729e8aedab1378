"""Networks without training, for tests and measurements."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Dimensions, Model
from tilenca.shapes.glyphs import GLYPHS

CLASSES = 10


def network(size: Dimensions, integer: Mapping[str, NDArray[Any]]) -> Model:
    """A model with these weights and biases, whole numbers in the tile's units, and up to ten classes."""
    exact = {
        name: array.astype(np.int8 if name.startswith("w") else np.int16) for name, array in integer.items()
    }
    labels = tuple(GLYPHS)[: max(1, min(CLASSES, size.channels - 1))]
    return Model(labels, size, exact, {name: array.astype(np.float32) for name, array in exact.items()})


def random_network(size: Dimensions, reach: int, bias: int | None = None, seed: int = 1) -> Model:
    """Weights of up to +-reach, ends included, and biases of up to +-bias, or 256 times reach."""
    random = np.random.default_rng(seed)
    most = {"w": reach, "b": 256 * reach if bias is None else bias}
    return network(
        size,
        {
            name: random.integers(-most[name[0]], most[name[0]] + 1, shape)
            for name, shape in size.shapes().items()
        },
    )


def uniform_network(size: Dimensions, weight: int, bias: int) -> Model:
    """A model with equal weights and equal biases."""
    each = {"w": weight, "b": bias}
    return network(size, {name: np.full(shape, each[name[0]]) for name, shape in size.shapes().items()})
