"""The firmware's own core, compiled for this machine: exact states, fast.

`make setup` builds the library from firmware/include/core and tools/simulator.
"""

import ctypes
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.model.file import NEIGHBOURHOOD, Model

WIDEST = 0  # kWidest of tools/simulator/update.h

LIBRARY = paths.BUILD / "simulator" / "libtilenca_core.so"


class CModel(ctypes.Structure):
    """`TilencaModel` of tools/simulator/core_api.cpp, good for as long as the arrays it was made of."""

    _fields_ = (
        *((name, ctypes.c_uint8) for name in ("channels", "hidden1", "hidden2", "classes")),
        *((f"{kind}{layer}", ctypes.c_void_p) for layer in (1, 2, 3) for kind in "wb"),
    )

    @classmethod
    def of(cls, model: Model) -> "CModel":
        """The model's sizes, and the addresses of its integer weights."""
        weights = [np.ascontiguousarray(model.integer[name]) for name in model.dimensions.shapes()]
        size = model.dimensions
        made = cls(size.channels, size.hidden1, size.hidden2, len(model.labels), *map(address, weights))
        made.weights = weights  # lives as long as the bare addresses do
        return made


def address(array: NDArray[Any]) -> int:
    """Where a contiguous array begins; the caller keeps it alive."""
    return int(array.ctypes.data)


@cache
def _library(path: Path) -> ctypes.CDLL:
    if not path.is_file():
        raise BuildError(f"{path}: not built yet; run: make setup")
    pointer, count = ctypes.c_void_p, ctypes.c_int32
    try:
        library = ctypes.CDLL(str(path))
        for name, arguments, result in (
            ("update_cells", [ctypes.POINTER(CModel), pointer, pointer, ctypes.c_size_t, count], count),
            ("tissue_new", [ctypes.POINTER(CModel), pointer, pointer, pointer], pointer),
            ("tissue_delete", [pointer], None),
            ("tissue_run", [pointer, count, count, pointer, pointer], None),
            ("tissue_updates", [pointer], ctypes.c_uint64),
            ("plan_new", [pointer], pointer),
            ("plan_delete", [pointer], None),
            ("plan_next", [pointer, pointer], count),
        ):
            function = getattr(library, f"tilenca_{name}")
            function.argtypes, function.restype = arguments, result
    except (OSError, AttributeError) as error:
        raise BuildError(f"{path}: not usable ({error}); remove it and run: make setup") from error
    return library


def library() -> ctypes.CDLL:
    """The compiled simulator.

    Raises:
        BuildError: it is not built, or another one; the message says how to build it.
    """
    return _library(LIBRARY)


def update_cells(
    model: Model, states: NDArray[np.int16], inputs: NDArray[np.int8], lanes: int = WIDEST
) -> NDArray[np.int16]:
    """One update of every cell by the firmware's core (docs/PROTOCOL.md section 4).

    Args:
        model: its integer weights are used.
        states: (..., C) int16 stored states, unit 2^-13; not changed.
        inputs: (..., 5 C) int8 messages: own, N, E, S, W; zeros for an absent neighbour.
        lanes: how many cells to compute side by side, the same to the bit: `WIDEST`, or 4, 8, 16, or one, by
            the very code of the chip.

    Returns:
        (..., C) int16, the new states.

    Raises:
        BuildError: the library is not built; the message says how.
        ValueError: shapes or types do not fit the model, or this machine cannot do so many lanes.
    """
    channels = model.dimensions.channels
    if states.dtype != np.int16 or states.shape[-1:] != (channels,):
        raise ValueError(f"states are {states.dtype} {states.shape}, the model needs int16 (..., {channels})")
    if inputs.dtype != np.int8 or inputs.shape != (*states.shape[:-1], NEIGHBOURHOOD * channels):
        wanted = (*states.shape[:-1], NEIGHBOURHOOD * channels)
        raise ValueError(f"inputs are {inputs.dtype} {inputs.shape}, the states need int8 {wanted}")
    new_states = np.array(states, dtype=np.int16, order="C")
    flat_inputs = np.ascontiguousarray(inputs)
    count = new_states.size // channels
    done = library().tilenca_update_cells(
        CModel.of(model), address(new_states), address(flat_inputs), count, lanes
    )
    if not done:
        raise ValueError(f"this machine cannot compute {lanes} cells side by side; use WIDEST")
    return new_states
