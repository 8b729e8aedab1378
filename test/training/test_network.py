"""The network: what a cell perceives, how it updates, and that fast and clear code agree."""

import numpy as np
import torch

from support.integer_network import perceive_by_convolution
from tilenca.model.file import LARGEST, SCALES, Dimensions
from tilenca.model.initial import initial_arrays
from tilenca.shapes.batch import Drawings
from tilenca.training.network import TileNet, perceive


def test_perceiving_real_cells_equals_a_convolution_over_the_whole_grid(drawings: Drawings) -> None:
    random = np.random.default_rng(1)
    for number, shape in enumerate(drawings.shapes):
        batch = drawings.batch(np.array([number]))
        state = torch.from_numpy(random.normal(size=(len(shape.cells), 21)).astype(np.float32))
        grid = torch.zeros(1, 21, len(shape.rows), len(shape.rows[0]))
        rows, columns = map(list, zip(*shape.cells, strict=True))
        grid[0, :, rows, columns] = state.T
        convolved = perceive_by_convolution(grid)[0, :, rows, columns].T
        perceived = perceive(state, state, torch.from_numpy(batch.neighbours.reshape(-1)))
        assert torch.equal(perceived, convolved), f"shape {shape.name}"


def test_own_message_is_perceived_as_it_is_and_neighbours_as_last_sent() -> None:
    own, sent = torch.full((2, 1), 3.0), torch.tensor([[5.0], [7.0]])
    side_by_side = torch.tensor(
        [2, 1, 2, 2, 2, 2, 2, 0]
    )  # cell 0 has cell 1 in the east, cell 1 cell 0 in the west
    assert perceive(own, sent, side_by_side).tolist() == [[3, 0, 7, 0, 0], [3, 0, 0, 0, 5]]


def test_an_untrained_cell_does_nothing() -> None:
    net = TileNet(
        Dimensions(21, 40, 40), True, initial_arrays(Dimensions(21, 40, 40), np.random.default_rng(0))
    )
    state = torch.randint(-127, 128, (9, 21)).float()
    after = net.update(state, torch.randint(-127, 128, (9, 105)).float(), torch.ones(9, 1), net.weights())
    assert torch.equal(after, state)


def test_projection_brings_every_weight_into_the_integer_range() -> None:
    huge = {name: np.full(shape, 1e3, np.float32) for name, shape in Dimensions(21, 40, 40).shapes().items()}
    net = TileNet(Dimensions(21, 40, 40), True, huge)
    net.project()
    for name, value in net.named_parameters():
        assert (value * SCALES[name] == LARGEST[name]).all(), name
