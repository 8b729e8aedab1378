"""The simulation engine that computes with PyTorch."""

from dataclasses import replace

import numpy as np

from firmware.synthetic_models import random_network
from tilenca.model.file import Dimensions, Model
from tilenca.training.float_engine import FloatEngine


def model(quantisation_aware: bool) -> Model:
    size = Dimensions(5, 6, 7)
    network = random_network(size, 40, seed=1)
    floats = {name: (array / 64).astype(np.float32) for name, array in network.integer.items()}
    return replace(network, floats=floats, metadata={"recipe": {"quantisation_aware": quantisation_aware}})


def test_in_the_tiles_arithmetic_messages_are_whole_and_states_saturate() -> None:
    engine = FloatEngine(model(quantisation_aware=True))
    states = engine.seed(4)
    assert (states.shape, states.dtype) == ((4, 5), np.dtype(np.float32))
    for _ in range(30):
        own = engine.message(states)
        assert np.array_equal(own, np.round(own))
        assert abs(own).max() <= 127
        states = engine.update(states, np.tile(own, 5))
        assert abs(states).max() <= 127


def test_in_real_numbers_messages_are_the_states() -> None:
    engine = FloatEngine(model(quantisation_aware=False))
    states = engine.seed(2) + np.float32(0.3)
    assert np.array_equal(engine.message(states), states)


def test_no_cells_are_no_work() -> None:
    engine = FloatEngine(model(quantisation_aware=True))
    assert engine.update(engine.seed(0), np.zeros((0, 25), np.float32)).shape == (0, 5)
