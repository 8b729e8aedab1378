"""Packed blocks: the weights in the order in which the tile's kernel reads them, and the accumulators' width.

Twin of `Layer` in firmware/include/core/layer.h; docs/PROTOCOL.md section 4 has the layout.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model

BLOCK_OUTPUTS = 8
HEAD_BYTES = 1 + 2 * BLOCK_OUTPUTS  # the width of the accumulators, biases
WEIGHT_OFFSET, BIAS_OFFSET = 128, 32768
ACTIVATION_MAX = 127
ROUNDING = 32  # what a hidden layer's sum starts with besides its bias
INT16_MIN, INT16_MAX = -(2**15), 2**15 - 1


@dataclass(frozen=True)
class Block:
    """Some outputs of a layer that are computed side by side.

    Attributes:
        outputs: their numbers.
        stream: the block's bytes in flash: the head, then a row of weights per input.
        least: the least value that any of its sums can take, for all inputs.
        most: the greatest.
        is_16_bit: whether a 16-bit accumulator holds every sum; else 24 bits do.
    """

    outputs: range
    stream: NDArray[np.uint8]
    least: int
    most: int
    is_16_bit: bool


def padded(outputs: int) -> int:
    """Outputs of whole blocks."""
    return -(-outputs // BLOCK_OUTPUTS) * BLOCK_OUTPUTS


def layer_bytes(inputs: int, outputs: int) -> int:
    """Bytes of flash that a layer takes."""
    return padded(outputs) // BLOCK_OUTPUTS * (HEAD_BYTES + BLOCK_OUTPUTS * inputs)


def blocks(model: Model, layer: int) -> list[Block]:
    """A layer of the model, 1 to 3, as the kernel reads it."""
    weights = model.integer[f"w{layer}"].astype(np.int64)
    biases = model.integer[f"b{layer}"].astype(np.int64)
    least_input = -ACTIVATION_MAX if layer == 1 else 0
    start = biases + (ROUNDING if layer < 3 else 0)
    ends = np.stack([weights * least_input, weights * ACTIVATION_MAX])
    least, most = start + ends.min(axis=0).sum(axis=1), start + ends.max(axis=0).sum(axis=1)
    found = []
    for first in range(0, len(weights), BLOCK_OUTPUTS):
        outputs = range(first, min(first + BLOCK_OUTPUTS, len(weights)))
        here = slice(outputs.start, outputs.stop)
        low, high = int(least[here].min()), int(most[here].max())
        is_16_bit = low >= INT16_MIN and high <= INT16_MAX
        stream = _stream(is_16_bit, weights[here], (start if is_16_bit else biases)[here])
        found.append(Block(outputs, stream, low, high, is_16_bit))
    return found


def _stream(is_16_bit: bool, weights: NDArray[np.int64], biases: NDArray[np.int64]) -> NDArray[np.uint8]:
    """The bytes of a block. 24-bit sums take unsigned weights; 16-bit sums start with the rounding added."""
    outputs, inputs = weights.shape
    absent = BLOCK_OUTPUTS - outputs
    weight_offset, bias_offset = (0, 0) if is_16_bit else (WEIGHT_OFFSET, BIAS_OFFSET)
    bias = (np.pad(biases, (0, absent)) + bias_offset).astype("<u2").view(np.uint8)
    rows = np.pad(weights, ((0, absent), (0, 0))).T + weight_offset
    return np.concatenate([[np.uint8(inputs if is_16_bit else 0)], bias, rows.astype(np.uint8).ravel()])


def outputs_in_16_bits(layer: list[Block]) -> int:
    """How many outputs have 16-bit accumulators."""
    return sum(len(one.outputs) for one in layer if one.is_16_bit)
