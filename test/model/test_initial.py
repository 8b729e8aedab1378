"""Weights that training begins with."""

import numpy as np
import pytest

from tilenca.model.file import Dimensions
from tilenca.model.initial import initial_arrays


@pytest.mark.parametrize("zero_last", [True, False])
def test_they_are_uniform_within_glorots_limit_and_biases_are_zero(zero_last: bool) -> None:
    size = Dimensions(21, 40, 30)
    arrays = initial_arrays(size, np.random.default_rng(1), zero_last)
    assert {name: array.shape for name, array in arrays.items()} == size.shapes()
    for name, array in arrays.items():
        assert array.dtype == np.float32
        if name.startswith("b") or (name == "w3" and zero_last):
            assert not array.any()
        else:
            limit = (6 / sum(array.shape)) ** 0.5
            assert 0.95 * limit < np.abs(array).max() <= limit
            assert abs(array.mean()) < 0.1 * limit


def test_a_seed_decides_them() -> None:
    first, again, other = (initial_arrays(Dimensions(), np.random.default_rng(n))["w1"] for n in (1, 1, 2))
    assert (first == again).all()
    assert (first != other).any()
