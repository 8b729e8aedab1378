"""The firmware's own core, compiled for this machine: exact states, fast.

`make setup` builds the library from firmware/include/core and tools/simulator.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.base import native_library
from tilenca.base.native_library import Library
from tilenca.model.file import NEIGHBOURHOOD, Model

WIDEST = 0  # as many cells side by side as the processor can

LIBRARY = native_library.find("simulator").library


def library() -> Library:
    """The compiled simulator.

    Raises:
        BuildError: it is not built, or cannot be used; the message says how to build it.
    """
    return native_library.load("simulator")


def pointer(array: NDArray[Any], kind: str) -> Any:
    """A contiguous array as a C array of `kind`; keeps it alive."""
    return library().ffi.from_buffer(f"{kind}[]", array)


def model_struct(model: Model) -> tuple[Any, list[Any]]:
    """The model as `tilenca_model`, and what must live as long as that."""
    size = model.dimensions
    names = size.shapes()  # in the order of the structure
    kinds = {"w": "int8_t", "b": "int16_t"}
    weights = [pointer(np.ascontiguousarray(model.integer[name]), kinds[name[0]]) for name in names]
    sizes = (size.channels, size.hidden1, size.hidden2, len(model.labels))
    return library().ffi.new("tilenca_model*", (*sizes, *weights)), weights


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
    network, _weights = model_struct(model)
    cells = pointer(new_states, "int16_t"), pointer(flat_inputs, "int8_t")
    if library().call("update_cells", network, *cells, count, lanes):
        raise ValueError(f"this machine cannot compute {lanes} cells side by side; use WIDEST")
    return new_states
