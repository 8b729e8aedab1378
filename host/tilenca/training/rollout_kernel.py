"""Training's inner loop, compiled for this machine: tools/rollout_kernel behind torch tensors.

`make setup-train` builds the library. `rollout.rollout_by_autograd` computes the same in plain PyTorch.
"""

from typing import Any, NamedTuple

import torch
from torch import Tensor

from tilenca.base import native_library
from tilenca.base.native_library import Library


class Tape(NamedTuple):
    """Inputs and results of E updates, or their gradients: (E, width) float32 each, rows padded."""

    seen: Tensor
    hidden1: Tensor
    hidden2: Tensor
    after: Tensor


def make_tape(updates: int, *widths: int) -> Tape:
    """An unwritten tape of `updates` rows; widths of perception, hidden layers and state."""
    block: int = library().lib.TILENCA_ROLLOUT_PADDING
    return Tape(*(torch.empty(updates, -(-width // block) * block)[:, :width] for width in widths))


def library() -> Library:
    """The compiled library.

    Raises:
        BuildError: it is not built, or not usable; the message says what to do.
    """
    return native_library.load("rollout")


class KernelRollout:
    """A network and a schedule in the library's form; keeps the arrays alive to which it points.

    Args:
        weights: w1, b1, w2, b2, w3, b3 as `TileNet.weights` gives them, float32.
        limit: of states and activations in the tile's whole numbers; None: plain real numbers.
        cells: N.
        counts: (T,) int64, updates of each tick.
        updating: (E,) int32, the cell of each update.
        reads: (E, 5) int32, rows it perceives: own, N + own as received, 2 N for an absent neighbour.
        arrives: (T, N) bool, at the end of the tick the neighbours receive the cell's message.
    """

    def __init__(
        self,
        weights: tuple[Tensor, ...],
        limit: float | None,
        cells: int,
        counts: Tensor,
        updating: Tensor,
        reads: Tensor,
        arrives: Tensor,
    ) -> None:
        self._alive = [tensor.contiguous() for tensor in (*weights, counts, updating, reads, arrives)]
        w1, _, w2, _, w3, _ = weights
        kinds = (*["float"] * len(weights), "int64_t", "int32_t", "int32_t", "uint8_t")
        pointers = [_pointer(tensor, kind) for tensor, kind in zip(self._alive, kinds, strict=True)]
        self.widths = (w1.shape[1], len(w1), len(w2), len(w3))
        sizes = (len(w3), len(w1), len(w2), limit is not None)
        infinite = float("inf") if limit is None else limit
        new = library().ffi.new
        self._network = new("tilenca_rollout_network*", (*sizes, infinite, *pointers[:6]))
        self._schedule = new("tilenca_rollout_schedule*", (cells, len(counts), *pointers[6:]))
        self.updates = len(updating)

    def forward(self, state: Tensor) -> Tape:
        """Runs the updates; `state` (N, C) float32 is changed in place."""
        tape = make_tape(self.updates, *self.widths)
        self._run("rollout_forward", state, tape)
        return tape

    def backward(self, d_state: Tensor, tape: Tape) -> Tape:
        """Gradients of the sums of every layer; `d_state` (N, C) float32 is changed in place."""
        gradients = make_tape(self.updates, 0, *self.widths[1:])
        self._run("rollout_backward", d_state, tape, gradients)
        return gradients

    def _run(self, function: str, state: Tensor, *tapes: Tape) -> None:
        places = [
            library().ffi.new("tilenca_rollout_tape*", [_pointer(tensor, "float") for tensor in tape])
            for tape in tapes
        ]
        library().call(function, self._network, self._schedule, _pointer(state, "float"), *places)


def _pointer(tensor: Tensor, kind: str) -> Any:
    """Where a tensor's elements begin; the caller keeps it alive."""
    return library().ffi.cast(f"{kind}*", tensor.data_ptr())
