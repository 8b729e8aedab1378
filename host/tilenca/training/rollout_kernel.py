"""Training's inner loop, compiled for this machine: tools/training behind torch tensors.

`make setup` builds the library. `rollout.rollout_by_autograd` computes the same in plain PyTorch.
"""

import ctypes
from functools import cache
from pathlib import Path
from typing import NamedTuple

import torch
from torch import Tensor

from tilenca.base import paths
from tilenca.base.errors import BuildError

LIBRARY = paths.BUILD / "training" / "libtilenca_life.so"
PADDING = 16  # twin of kPadding in tools/training/lanes.h


class _CNet(ctypes.Structure):
    """`Net` of tools/training/life.h."""

    _fields_ = (
        *((name, ctypes.c_int32) for name in ("channels", "hidden1", "hidden2", "rounded")),
        ("limit", ctypes.c_float),
        *((name, ctypes.c_void_p) for name in ("w1", "b1", "w2", "b2", "w3", "b3")),
    )


class _CRollout(ctypes.Structure):
    """`Life` of the same header."""

    _fields_ = (
        ("cells", ctypes.c_int32),
        ("ticks", ctypes.c_int32),
        *((name, ctypes.c_void_p) for name in ("counts", "updating", "reads", "arrives")),
    )


class _CTape(ctypes.Structure):
    """`Tape` of the same header."""

    _fields_ = tuple((name, ctypes.c_void_p) for name in ("seen", "hidden1", "hidden2", "after"))


class Tape(NamedTuple):
    """Inputs and results of E updates, or their gradients: (E, width) float32 each, rows padded."""

    seen: Tensor
    hidden1: Tensor
    hidden2: Tensor
    after: Tensor


def make_tape(updates: int, *widths: int) -> Tape:
    """An unwritten tape of `updates` rows; widths of perception, hidden layers and state."""
    return Tape(*(torch.empty(updates, -(-width // PADDING) * PADDING)[:, :width] for width in widths))


@cache
def library(path: Path = LIBRARY) -> ctypes.CDLL:
    """The compiled library.

    Raises:
        BuildError: it is not built, or not usable; the message says what to do.
    """
    if not path.is_file():
        raise BuildError(f"{path}: not built yet; run: make setup-train")
    try:
        found = ctypes.CDLL(str(path))
        found.tilenca_life_forward.restype = found.tilenca_life_backward.restype = None
        found.tilenca_life_kind.restype = ctypes.c_char_p
    except (OSError, AttributeError) as error:
        raise BuildError(f"{path}: not usable ({error}); remove it and run: make setup-train") from error
    return found


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
        pointers = [tensor.data_ptr() for tensor in self._alive]
        self.widths = (w1.shape[1], len(w1), len(w2), len(w3))
        infinite = float("inf") if limit is None else limit
        self._net = _CNet(len(w3), len(w1), len(w2), limit is not None, infinite, *pointers[:6])
        self._rollout = _CRollout(cells, len(counts), *pointers[6:])
        self.updates = len(updating)

    def forward(self, state: Tensor) -> Tape:
        """Runs the updates; `state` (N, C) float32 is changed in place."""
        tape = make_tape(self.updates, *self.widths)
        library().tilenca_life_forward(
            ctypes.byref(self._net),
            ctypes.byref(self._rollout),
            ctypes.c_void_p(state.data_ptr()),
            ctypes.byref(_pointers(tape)),
        )
        return tape

    def backward(self, d_state: Tensor, tape: Tape) -> Tape:
        """Gradients of the sums of every layer; `d_state` (N, C) float32 is changed in place."""
        gradients = make_tape(self.updates, 0, *self.widths[1:])
        library().tilenca_life_backward(
            ctypes.byref(self._net),
            ctypes.byref(self._rollout),
            ctypes.c_void_p(d_state.data_ptr()),
            ctypes.byref(_pointers(tape)),
            ctypes.byref(_pointers(gradients)),
        )
        return gradients


def _pointers(tape: Tape) -> _CTape:
    return _CTape(*(tensor.data_ptr() for tensor in tape))
