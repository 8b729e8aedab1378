"""The weights in the order in which the tile's kernel reads them, and how many bits its sums need.

Twin of `Layer` in firmware/include/core/layer.h; docs/PROTOCOL.md section 4 has the layout.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model

PASS_OUTPUTS = 8
HEAD_BYTES = 1 + 2 * PASS_OUTPUTS  # what kind of sums, biases
WEIGHT_OFFSET, BIAS_OFFSET = 128, 32768
ACTIVATION_MAX = 127
ROUNDING = 32  # what a hidden layer's sum starts with besides its bias
NARROW_MIN, NARROW_MAX = -(2**15), 2**15 - 1


@dataclass(frozen=True)
class Pass:
    """Some outputs of a layer that are computed side by side.

    Attributes:
        outputs: which.
        stream: its bytes in flash: the head, then a row of weights per input.
        least: the least value any of its sums can take, whatever the inputs.
        most: the greatest.
        narrow: whether 16 bits hold every sum.
    """

    outputs: range
    stream: NDArray[np.uint8]
    least: int
    most: int
    narrow: bool


def padded(outputs: int) -> int:
    """Outputs of whole passes."""
    return -(-outputs // PASS_OUTPUTS) * PASS_OUTPUTS


def layer_bytes(inputs: int, outputs: int) -> int:
    """Bytes of flash that a layer takes."""
    return padded(outputs) // PASS_OUTPUTS * (HEAD_BYTES + PASS_OUTPUTS * inputs)


def passes(model: Model, layer: int) -> list[Pass]:
    """A layer of the model, 1 to 3, as the kernel reads it."""
    weights = model.integer[f"w{layer}"].astype(np.int64)
    biases = model.integer[f"b{layer}"].astype(np.int64)
    least_input = -ACTIVATION_MAX if layer == 1 else 0
    start = biases + (ROUNDING if layer < 3 else 0)
    ends = np.stack([weights * least_input, weights * ACTIVATION_MAX])
    least, most = start + ends.min(axis=0).sum(axis=1), start + ends.max(axis=0).sum(axis=1)
    found = []
    for first in range(0, len(weights), PASS_OUTPUTS):
        outputs = range(first, min(first + PASS_OUTPUTS, len(weights)))
        here = slice(outputs.start, outputs.stop)
        low, high = int(least[here].min()), int(most[here].max())
        narrow = low >= NARROW_MIN and high <= NARROW_MAX
        stream = _stream(narrow, weights[here], (start if narrow else biases)[here])
        found.append(Pass(outputs, stream, low, high, narrow))
    return found


def _stream(narrow: bool, weights: NDArray[np.int64], biases: NDArray[np.int64]) -> NDArray[np.uint8]:
    """The bytes of a pass. Sums of 24 bits are of unsigned weights, those of 16 bits start rounded."""
    outputs, inputs = weights.shape
    absent = PASS_OUTPUTS - outputs
    weight_offset, bias_offset = (0, 0) if narrow else (WEIGHT_OFFSET, BIAS_OFFSET)
    bias = (np.pad(biases, (0, absent)) + bias_offset).astype("<u2").view(np.uint8)
    rows = np.pad(weights, ((0, absent), (0, 0))).T + weight_offset
    return np.concatenate([[np.uint8(inputs if narrow else 0)], bias, rows.astype(np.uint8).ravel()])


def narrow_outputs(layer: list[Pass]) -> int:
    """How many outputs have sums of 16 bits."""
    return sum(len(one.outputs) for one in layer if one.narrow)
