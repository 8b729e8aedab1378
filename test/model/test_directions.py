"""What a tile says is missing, and models that get directions."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware.synthetic_models import random_network
from tilenca.model.directions import NOWHERE, missing_sides, with_directions
from tilenca.model.file import Dimensions, Model, load_model
from tilenca.simulator.core_library import update_cells


def states(*scores: tuple[int, int, int, int]) -> NDArray[Any]:
    """One channel of the seed, four directions and two classes."""
    return np.array([[8192, *each, 8192, 0] for each in scores], np.int16)


def test_the_greatest_score_above_a_half_is_said() -> None:
    found = missing_sides(states((8192, 0, 0, 0), (0, 4300, 5000, 0), (0, 0, 0, 0), (-9000, 0, 0, 6000)), 2)
    assert found.tolist() == [0, 2, NOWHERE, 3]


def test_a_half_as_a_message_is_not_above_it_and_the_first_of_equals_counts() -> None:
    """Message 32 is up to 32 * 128 + 63; two scores of the same message are equal."""
    found = missing_sides(states((4096 + 63, 0, 0, 0), (4096 + 64, 0, 0, 0), (0, 5000, 5010, 0)), 2)
    assert found.tolist() == [NOWHERE, 0, 1]


@pytest.mark.parametrize("labels", [("a",), ("a", "b", "c")])
def test_a_model_that_gets_directions_does_what_it_did(labels: tuple[str, ...]) -> None:
    old = random_network(Dimensions(6, 7, 9), 1)
    old = Model(labels, old.dimensions, old.integer, old.floats)
    new = with_directions(old)
    assert new.dimensions == Dimensions(10, 7, 9, 4)
    random = np.random.default_rng(1)
    state = random.integers(-9000, 9000, (50, 6)).astype(np.int16)
    inputs = random.integers(-127, 128, (50, 5, 6)).astype(np.int8)
    at = 6 - len(labels)
    wide_state = np.insert(state, [at] * 4, 0, axis=1)
    wide_inputs = np.insert(inputs, [at] * 4, 0, axis=2)
    after = update_cells(old, state, inputs.reshape(50, -1))
    wide_after = update_cells(new, wide_state, wide_inputs.reshape(50, -1))
    assert (np.delete(wide_after, range(at, at + 4), axis=1) == after).all()
    assert (missing_sides(wide_after, len(labels)) == NOWHERE).all()


def test_directions_are_kept_on_disk_and_tell_models_apart(tmp_path: Path) -> None:
    old = random_network(Dimensions(6, 7, 9), 1)
    old = Model(("1", "2"), old.dimensions, old.integer, old.floats)
    new = with_directions(old)
    new.save(tmp_path)
    assert load_model(tmp_path).dimensions == new.dimensions
    assert load_model(tmp_path).model_id == new.model_id
    blind = Model(new.labels, Dimensions(10, 7, 9), new.integer, new.floats)
    assert blind.model_id != new.model_id
