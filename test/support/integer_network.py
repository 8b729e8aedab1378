"""Clear references in PyTorch that fast code must equal: the integer network, convolution as perception."""

import numpy as np
import torch
import torch.nn.functional as F  # noqa: N812 - the usual name
from numpy.typing import NDArray
from torch import Tensor

from tilenca.model.file import NEIGHBOURHOOD, Model
from tilenca.protocol.constants import HIDDEN_MAX, STATE_MAX
from tilenca.simulator.engine import ExactEngine, States


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


class IntegerEngine(ExactEngine):
    """The same states as `FastEngine`, by `IntegerNet`."""

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self.net = IntegerNet(model)

    def update(self, states: States, seen: States) -> NDArray[np.int16]:
        """(N, C) int16."""
        return self.net.update(torch.from_numpy(states), torch.from_numpy(seen)).numpy()


def perceive_by_convolution(grid: Tensor) -> Tensor:
    """The same as `perceive` on a whole grid, as the paper writes it: a 3 x 3 convolution without corners.

    Args:
        grid: (B, C, H, W) float32 messages, zero where there is no tile.

    Returns:
        (B, 5 * C, H, W) float32, same tap order as `perceive`.
    """
    channels = grid.shape[1]
    kernel = torch.zeros(NEIGHBOURHOOD * channels, channels, 3, 3, dtype=grid.dtype)
    for tap, (row, col) in enumerate(((1, 1), (0, 1), (1, 2), (2, 1), (1, 0))):
        for channel in range(channels):
            kernel[tap * channels + channel, channel, row, col] = 1.0
    return F.conv2d(grid, kernel, padding=1)
