"""The firmware's own core, compiled for this machine: exact states, fast.

`make setup` builds the library from firmware/src/core; nothing is computed in Python here.
"""

import ctypes
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca import paths
from tilenca.errors import BuildError
from tilenca.modelfile import TAPS, Model

LIBRARY = paths.BUILD / "simulator" / "libtilenca_core.so"


class _CModel(ctypes.Structure):
    """`TilencaModel` of tools/simulator/core_api.cpp."""

    _fields_ = (
        ("channels", ctypes.c_uint8),
        ("hidden1", ctypes.c_uint8),
        ("hidden2", ctypes.c_uint8),
        *((f"{kind}{layer}", ctypes.c_void_p) for layer in (1, 2, 3) for kind in "wb"),
    )


@cache
def _library(path: Path) -> ctypes.CDLL:
    if not path.is_file():
        raise BuildError(f"{path}: not built yet; run: make setup")
    try:
        library = ctypes.CDLL(str(path))
        update_cells = library.tilenca_update_cells
    except (OSError, AttributeError) as error:
        raise BuildError(f"{path}: not usable ({error}); remove it and run: make setup") from error
    update_cells.argtypes = [ctypes.POINTER(_CModel), ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]
    update_cells.restype = None
    return library


def update_cells(model: Model, states: NDArray[np.int16], inputs: NDArray[np.int8]) -> NDArray[np.int16]:
    """One update of every cell by the firmware's core (docs/PROTOCOL.md section 4).

    Args:
        model: its integer weights are used.
        states: (..., C) int16 stored states, unit 2^-13; not changed.
        inputs: (..., 5 C) int8 messages: own, N, E, S, W; zeros for an absent neighbour.

    Returns:
        (..., C) int16, the new states.

    Raises:
        BuildError: the library is not built; the message says how.
        ValueError: shapes or types do not fit the model.
    """
    channels = model.dimensions.channels
    if states.dtype != np.int16 or states.shape[-1:] != (channels,):
        raise ValueError(f"states are {states.dtype} {states.shape}, the model needs int16 (..., {channels})")
    if inputs.dtype != np.int8 or inputs.shape != (*states.shape[:-1], TAPS * channels):
        wanted = (*states.shape[:-1], TAPS * channels)
        raise ValueError(f"inputs are {inputs.dtype} {inputs.shape}, the states need int8 {wanted}")
    library = _library(LIBRARY)
    # The arrays must stay alive during the call: the structure holds bare addresses.
    weights = [np.ascontiguousarray(model.integer[name]) for name in model.dimensions.shapes()]
    size = model.dimensions
    c_model = _CModel(size.channels, size.hidden1, size.hidden2, *(array.ctypes.data for array in weights))
    new_states = np.array(states, dtype=np.int16, order="C")
    flat_inputs = np.ascontiguousarray(inputs)
    count = new_states.size // channels
    library.tilenca_update_cells(
        ctypes.byref(c_model), new_states.ctypes.data, flat_inputs.ctypes.data, count
    )
    return new_states
