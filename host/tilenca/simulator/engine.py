"""The update of a cell in the firmware's arithmetic; `training.float_engine` computes it with tensors."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model
from tilenca.protocol.constants import MESSAGE_SHIFT
from tilenca.simulator import core_library

SEED_STATE = 8192  # 1.0 in units of 2^-13

States = NDArray[Any]  # (N, C), of the engine's own type


class Engine(Protocol):
    """The computation of one cell, for many cells at once."""

    channels: int
    classes: int

    def seed(self, cells: int) -> States:
        """(cells, C) states of tiles that were just switched on."""

    def message(self, states: States) -> States:
        """(N, C) the messages that cells send, and perceive as their own."""

    def update(self, states: States, seen: States) -> States:
        """(N, C) new states from the old ones and (N, 5 C) messages: own, N, E, S, W."""


class ExactEngine:
    """States and messages as on a tile; subclasses compute the update."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.channels = model.dimensions.channels
        self.classes = len(model.labels)

    def seed(self, cells: int) -> NDArray[np.int16]:
        """(cells, C) int16, the seed state."""
        states = np.zeros((cells, self.channels), np.int16)
        states[:, 0] = SEED_STATE
        return states

    def message(self, states: States) -> NDArray[np.int8]:
        """(N, C) int8, stored states rounded to their message."""
        return ((states.astype(np.int32) + (1 << MESSAGE_SHIFT - 1)) >> MESSAGE_SHIFT).astype(np.int8)


class FastEngine(ExactEngine):
    """The firmware's portable core: every state to the bit as on a tile. `Simulator` runs it compiled."""

    def update(self, states: States, seen: States) -> NDArray[np.int16]:
        """(N, C) int16, one update by the firmware's core."""
        return core_library.update_cells(self.model, states, seen)
