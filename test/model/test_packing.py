"""How many bits the sums of packed blocks need."""

from dataclasses import replace

import numpy as np
import pytest

from firmware.synthetic_models import random_network
from tilenca.model import packing
from tilenca.model.file import Dimensions, Model

SIZE = Dimensions(5, 7, 6)


@pytest.fixture
def model() -> Model:
    return replace(random_network(SIZE, 127, seed=3), labels=("4", "b", "-"))


def one_layer(weights: list[list[int]], biases: list[int], layer: int) -> packing.Block:
    """The only pass of a layer with these weights."""
    model = random_network(Dimensions(1, 1, 1), 1)
    integer = dict(model.integer)
    integer[f"w{layer}"], integer[f"b{layer}"] = np.array(weights, np.int8), np.array(biases, np.int16)
    (found,) = packing.blocks(replace(model, integer=integer), layer)
    return found


def test_the_bounds_of_a_pass_are_those_of_its_outermost_outputs() -> None:
    found = one_layer([[127, -127], [1, 2]], [0, -32768], layer=1)
    assert (found.least, found.most) == (-3 * 127 - 32768 + 32, 2 * 127 * 127 + 32)
    found = one_layer([[127, -127], [1, 2]], [7, -100], layer=2)
    assert (found.least, found.most) == (7 - 127 * 127 + 32, 7 + 127 * 127 + 32), (
        "activations are not negative"
    )
    found = one_layer([[127, -127], [1, 2]], [7, -100], layer=3)
    assert (found.least, found.most) == (7 - 127 * 127, 7 + 127 * 127), "nothing is rounded"


@pytest.mark.parametrize(
    ("weights", "bias", "layer", "narrow"),
    [
        ([127, 127], 32767 - 2 * 127 * 127, 3, True),
        ([127, 127], 32768 - 2 * 127 * 127, 3, False),
        ([127, 127], 32767 - 2 * 127 * 127 - 32, 2, True),
        ([127, 127], 32767 - 2 * 127 * 127 - 31, 2, False),
        ([-127, -127], -32768 + 2 * 127 * 127, 3, True),
        ([-127, -127], -32769 + 2 * 127 * 127, 3, False),
        ([-127, 127], -32769 + 2 * 127 * 127, 3, True),
        ([-127, 127], -32769 + 2 * 127 * 127 - 32, 1, False),
    ],
)
def test_16_bits_are_used_where_no_input_can_make_them_wrap(
    weights: list[int], bias: int, layer: int, narrow: bool
) -> None:
    assert one_layer([weights], [bias], layer).is_16_bit is narrow
    assert one_layer([[0, 0], weights], [0, bias], layer).is_16_bit is narrow, "the worst output decides"
