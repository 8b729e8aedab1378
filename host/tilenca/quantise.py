"""From trained real weights to the tile's integers (docs/PROTOCOL.md section 4), and their PyTorch twin."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from tilenca.model import LARGEST, STEPS
from tilenca.modelfile import Dimensions, Model
from tilenca.protocol import HIDDEN_MAX, STATE_MAX


def quantise(
    dimensions: Dimensions,
    labels: tuple[str, ...],
    floats: Mapping[str, NDArray[np.float32]],
    made: Mapping[str, Any],
) -> tuple[Model, int]:
    """Rounds real weights to the tile's integers.

    Returns:
        The model, and how many weights lay outside the integer range and were cut to it: none after bounded
        training.
    """
    integer: dict[str, NDArray[Any]] = {}
    cut = 0
    for name in dimensions.shapes():
        units = np.floor(floats[name].astype(np.float64) * STEPS[name] + 0.5)
        cut += int((np.abs(units) > LARGEST[name]).sum())
        kind = np.int8 if name.startswith("w") else np.int16
        integer[name] = np.clip(units, -LARGEST[name], LARGEST[name]).astype(kind)
    return Model(labels, dimensions, integer, dict(floats), made), cut


class IntegerNet:
    """The integer network in PyTorch, equal to the tile in every bit.

    Its tensors hold whole numbers as float32, which a matrix product adds exactly: sums stay below 2^23
    (docs/PROTOCOL.md section 4), and float32 has every whole number up to 2^24.
    """

    def __init__(self, model: Model) -> None:
        self.weights = {
            name: torch.from_numpy(model.integer[name].astype(np.float32)) for name in model.integer
        }

    def update(self, states: Tensor, seen: Tensor) -> Tensor:
        """One update of every cell.

        Args:
            states: (N, C) int16 stored states.
            seen: (N, 5 * C) int8 messages: own, N, E, S, W.

        Returns:
            (N, C) int16.
        """
        weights = self.weights
        hidden = self._layer(seen.to(torch.float32), weights["w1"], weights["b1"])
        hidden = self._layer(hidden, weights["w2"], weights["b2"])
        change = torch.addmm(weights["b3"], hidden, weights["w3"].t())
        return (states.to(torch.float32) + change).clamp(-STATE_MAX, STATE_MAX).to(torch.int16)

    @staticmethod
    def _layer(inputs: Tensor, weights: Tensor, biases: Tensor) -> Tensor:
        # x / 64 is exact, so floor() is the arithmetic shift.
        return torch.floor((torch.addmm(biases, inputs, weights.t()) + 32) / 64).clamp(0, HIDDEN_MAX)
