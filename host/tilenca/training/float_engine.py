"""The simulation engine that computes with PyTorch, in real numbers."""

import numpy as np
import torch
from numpy.typing import NDArray

from tilenca.model.file import Model
from tilenca.simulator.engine import States
from tilenca.training.network import TileNet


class FloatEngine:
    """The trained network: in the tile's arithmetic, or in plain real numbers."""

    def __init__(self, model: Model) -> None:
        quantisation_aware = bool(model.metadata.get("recipe", {}).get("quantisation_aware", True))
        self.net = TileNet(model.dimensions, quantisation_aware, model.floats)
        self.weights = self.net.weights()
        self.channels = model.dimensions.channels
        self.classes = len(model.labels)

    def seed(self, cells: int) -> NDArray[np.float32]:
        """(cells, C) float32, the seed state in the net's units."""
        states = np.zeros((cells, self.channels), np.float32)
        states[:, 0] = self.net.units
        return states

    @torch.inference_mode()
    def message(self, states: States) -> NDArray[np.float32]:
        """(N, C) float32."""
        return self.net.message(torch.from_numpy(states)).numpy()

    @torch.inference_mode()
    def update(self, states: States, seen: States) -> NDArray[np.float32]:
        """(N, C) float32."""
        fires = torch.ones(len(states), 1)
        return self.net.update(torch.from_numpy(states), torch.from_numpy(seen), fires, self.weights).numpy()
