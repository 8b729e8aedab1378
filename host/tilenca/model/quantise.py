"""From trained real weights to the tile's integers (docs/PROTOCOL.md section 4)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import LARGEST, SCALES, Dimensions, Model


def quantise(
    dimensions: Dimensions,
    labels: tuple[str, ...],
    floats: Mapping[str, NDArray[np.float32]],
    metadata: Mapping[str, Any],
) -> tuple[Model, int]:
    """Rounds real weights to the tile's integers.

    Returns:
        The model, and how many weights lay outside the integer range and were cut to it: none after
        quantisation-aware training.
    """
    integer: dict[str, NDArray[Any]] = {}
    cut = 0
    for name in dimensions.shapes():
        units = np.floor(floats[name].astype(np.float64) * SCALES[name] + 0.5)
        cut += int((np.abs(units) > LARGEST[name]).sum())
        kind = np.int8 if name.startswith("w") else np.int16
        integer[name] = np.clip(units, -LARGEST[name], LARGEST[name]).astype(kind)
    return Model(labels, dimensions, integer, dict(floats), metadata), cut
