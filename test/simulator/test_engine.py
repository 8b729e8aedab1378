"""States and messages as on a tile."""

import numpy as np

from firmware.synthetic_models import random_network
from tilenca.model.file import Dimensions
from tilenca.protocol.constants import MESSAGE_MAX, MESSAGE_SHIFT, STATE_MAX
from tilenca.simulator import core_library
from tilenca.simulator.engine import SEED_STATE, FastEngine

SIZE = Dimensions(5, 6, 7)
ENGINE = FastEngine(random_network(SIZE, 40, seed=1))


def test_a_tile_begins_with_one_in_its_first_channel_and_tells_it() -> None:
    states = ENGINE.seed(3)
    assert states.dtype == np.int16
    assert states.tolist() == [[SEED_STATE, 0, 0, 0, 0]] * 3
    assert ENGINE.message(states).tolist() == [[64, 0, 0, 0, 0]] * 3
    assert ENGINE.seed(0).shape == (0, 5)


def test_messages_are_rounded_to_the_nearest_and_halves_go_up() -> None:
    one = 1 << MESSAGE_SHIFT
    states = np.array([[0, one // 2 - 1, one // 2, -one // 2, -one // 2 - 1]], np.int16)
    assert ENGINE.message(states).tolist() == [[0, 0, 1, 0, -1]]
    extremes = np.array([[STATE_MAX, -STATE_MAX, one, -one, 0]], np.int16)
    assert ENGINE.message(extremes).tolist() == [[MESSAGE_MAX, -MESSAGE_MAX, 1, -1, 0]]


def test_an_update_is_the_cores() -> None:
    random = np.random.default_rng(2)
    states = random.integers(-STATE_MAX, STATE_MAX + 1, (9, 5)).astype(np.int16)
    seen = random.integers(-MESSAGE_MAX, MESSAGE_MAX + 1, (9, 25)).astype(np.int8)
    np.testing.assert_array_equal(
        ENGINE.update(states, seen), core_library.update_cells(ENGINE.model, states, seen)
    )


def test_it_has_the_models_widths_and_classes() -> None:
    assert (ENGINE.channels, ENGINE.classes) == (5, len(ENGINE.model.labels))
