"""The network of a tile in PyTorch: perceive, then update.

Training works on flat batches of real cells (see `tilenca.shapes.batch`); tests compare `perceive` with a
convolution on a padded grid. The firmware's `core/network` is the integer twin of the quantisation-aware
network.
"""

from collections.abc import Mapping
from typing import Any, cast

import numpy as np
import torch
import torch.nn.functional as F  # noqa: N812 - the usual name
from numpy.typing import NDArray
from torch import Tensor, nn

from tilenca.model.file import LARGEST, SCALES, Dimensions

# The quantisation-aware network computes in units of 1/64, in which a tile's messages and activations are
# whole numbers (docs/PROTOCOL.md section 4). float32 holds every value on the way exactly: the results are
# those of the integer tile, to the bit.
UNITS = 64
LIMIT = 127.0


class _Round(torch.autograd.Function):
    """floor(x + 1/2), which rounds halves up as the tile does; straight-through gradient."""

    @staticmethod
    def forward(ctx: Any, value: Tensor) -> Tensor:
        return torch.floor(value + 0.5)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return gradients[0]


def round_half_up(value: Tensor) -> Tensor:
    """The nearest whole number, halves rounded up; its gradient is that of the identity."""
    return cast(Tensor, _Round.apply(value))  # type: ignore[no-untyped-call]


def perceive(own: Tensor, sent: Tensor, neighbours: Tensor) -> Tensor:
    """Own message, then the N, E, S, W neighbours'; a missing neighbour reads as zero.

    Args:
        own: (N, C) float32, every cell's own message.
        sent: (N, C) float32, the last message that neighbours received from each cell.
        neighbours: (4 * N,) int64, for each cell its N, E, S, W neighbour; N for none.

    Returns:
        (N, 5 * C) float32, in the order that docs/PROTOCOL.md fixes.
    """
    with_absent = F.pad(sent, (0, 0, 0, 1))
    around = with_absent.index_select(0, neighbours).view(own.shape[0], -1)
    return torch.cat((own, around), dim=1)


class TileNet(nn.Module):
    """The network every tile runs: 5 C -> H1 relu -> H2 relu -> C, added to the state.

    States, messages and activations are in units of `1 / net.units`.

    Args:
        dimensions: the widths.
        quantisation_aware: compute exactly what the integer tile computes, with gradients as if nothing had
            been rounded; False: plain real numbers, as the paper does.
        arrays: initial weights by name (float32, shapes of `Dimensions.shapes`).
    """

    def __init__(
        self, dimensions: Dimensions, quantisation_aware: bool, arrays: Mapping[str, NDArray[np.float32]]
    ) -> None:
        super().__init__()
        self.dimensions = dimensions
        self.quantisation_aware = quantisation_aware
        self.units = UNITS if quantisation_aware else 1
        self.limit = LIMIT if quantisation_aware else torch.inf
        for name in dimensions.shapes():
            self.register_parameter(name, nn.Parameter(torch.from_numpy(arrays[name].copy())))

    def arrays(self) -> dict[str, NDArray[np.float32]]:
        """The weights by name, as `Model.floats` wants them."""
        return {name: value.detach().cpu().numpy().copy() for name, value in self.named_parameters()}

    def weights(self) -> tuple[Tensor, ...]:
        """w1, b1, w2, b2, w3, b3 for the computation: rounded to the tile's steps, biases in units."""
        rounded = {
            name: round_half_up(value * SCALES[name]) / SCALES[name] if self.quantisation_aware else value
            for name, value in self.named_parameters()
        }
        return tuple(value * self.units if name.startswith("b") else value for name, value in rounded.items())

    def message(self, state: Tensor) -> Tensor:
        """(N, C) the message of a cell: its state, rounded to whole units if quantisation-aware."""
        return round_half_up(state) if self.quantisation_aware else state

    def update(self, state: Tensor, perceived: Tensor, fires: Tensor, weights: tuple[Tensor, ...]) -> Tensor:
        """One update of the cells that fire; the others keep their state.

        Args:
            state: (N, C) float32.
            perceived: (N, 5 * C) float32.
            fires: (N, 1) float32, 1 for a cell that updates now, else 0.
            weights: `weights()`.

        Returns:
            (N, C) float32.
        """
        w1, b1, w2, b2, w3, b3 = weights
        # hardtanh is clamp with no gradient at the limits.
        hidden = F.hardtanh(self.message(F.linear(perceived, w1, b1)), 0.0, self.limit)
        hidden = F.hardtanh(self.message(F.linear(hidden, w2, b2)), 0.0, self.limit)
        return F.hardtanh(torch.addcmul(state, F.linear(hidden, w3, b3), fires), -self.limit, self.limit)

    @torch.no_grad()
    def project(self) -> None:
        """Brings weights back into the range that the integer tile can hold."""
        for name, value in self.named_parameters():
            value.clamp_(-LARGEST[name] / SCALES[name], LARGEST[name] / SCALES[name])
