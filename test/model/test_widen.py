"""A wider network that computes what a narrower one does."""

import numpy as np
import pytest

from tilenca.model.directions import with_directions
from tilenca.model.file import Dimensions, Model
from tilenca.model.initial import initial_arrays
from tilenca.model.quantise import quantise
from tilenca.model.widen import widened
from tilenca.simulator.core_library import update_cells

BIASES = ("b1", "b2", "b3")


def network(size: Dimensions) -> Model:
    """Random weights, so small that few units are saturated."""
    random = np.random.default_rng(1)
    floats = initial_arrays(size, random, zero_last=False)
    floats |= {name: random.uniform(-0.2, 0.2, floats[name].shape).astype(np.float32) for name in BIASES}
    model, cut = quantise(size, ("a", "b"), floats, {"recipe_name": "none"})
    assert cut == 0
    return model


@pytest.mark.parametrize("size", [Dimensions(9, 7, 9), Dimensions(6, 12, 14), Dimensions(10, 8, 11)])
def test_it_does_what_the_narrower_one_did(size: Dimensions) -> None:
    old = network(Dimensions(6, 7, 9))
    new = widened(old, size, np.random.default_rng(1))
    assert (new.dimensions, new.labels, new.metadata) == (size, old.labels, old.metadata)
    more = size.channels - 6
    random = np.random.default_rng(2)
    state = random.integers(-9000, 9000, (50, 6)).astype(np.int16)
    inputs = random.integers(-127, 128, (50, 5, 6)).astype(np.int8)
    wide_state = np.insert(state, [1] * more, 0, axis=1)
    wide_inputs = np.insert(inputs, [1] * more, 0, axis=2)
    after = update_cells(old, state, inputs.reshape(50, -1))
    wide_after = update_cells(new, wide_state, wide_inputs.reshape(50, -1))
    assert (np.delete(wide_after, range(1, 1 + more), axis=1) == after).all()
    assert (wide_after[:, 1 : 1 + more] == 0).all()
    assert (after != state).any()


def test_what_is_new_reads_all_of_the_state() -> None:
    """Else no gradient would reach it."""
    new = widened(network(Dimensions(6, 7, 9)), Dimensions(8, 9, 12), np.random.default_rng(1))
    assert (new.floats["w1"][7:] != 0).all()
    assert (new.floats["w1"].reshape(9, 5, 8)[:, :, 1:3] != 0).all()
    assert (new.floats["w2"][9:] != 0).all()


def test_directions_stay_and_narrower_ones_are_refused() -> None:
    old = with_directions(network(Dimensions(6, 7, 9)))
    random = np.random.default_rng(1)
    assert widened(old, Dimensions(12, 7, 9, 4), random).dimensions.directions == 4
    for size in (
        Dimensions(12, 7, 9),
        Dimensions(9, 7, 9, 4),
        Dimensions(10, 6, 9, 4),
        Dimensions(10, 7, 8, 4),
    ):
        with pytest.raises(ValueError, match="cannot hold"):
            widened(old, size, random)
