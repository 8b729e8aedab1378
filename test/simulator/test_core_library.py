"""The firmware's core on the host against the arithmetic of docs/PROTOCOL.md, written out in numpy."""

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware.synthetic_models import network, random_network, uniform_network
from support.reference_network import reference
from tilenca.model.file import Dimensions, Model
from tilenca.simulator import core_library, rollout_library

SEED_STATE = 8192


SIZES = [
    Dimensions(21, 40, 40),
    Dimensions(1, 1, 1),
    Dimensions(3, 9, 7),
    Dimensions(51, 127, 127),
    Dimensions(37, 64, 64),
]


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("reach", [2, 20, 127])
def test_every_state_of_a_long_run_is_the_reference(size: Dimensions, reach: int) -> None:
    """A ring of cells that hear each other on all four sides."""
    model = random_network(size, reach, seed=reach)
    states = np.zeros((12, size.channels), dtype=np.int16)
    states[:, 0] = SEED_STATE
    # Cells that differ, or all would stay equal: some start at the extremes.
    states[1:4] = [[16256], [-16256], [-1]]
    for step in range(200):
        messages = ((states.astype(np.int32) + 64) >> 7).astype(np.int8)
        taps = [np.roll(messages, shift, axis=0) for shift in (0, 1, 2, 3)]
        inputs = np.concatenate([*taps, np.zeros_like(messages)], axis=1)
        expected = reference(model, states, inputs)
        states = core_library.update_cells(model, states, inputs)
        assert states.dtype == np.int16
        np.testing.assert_array_equal(states, expected, err_msg=f"step {step}")


@pytest.mark.parametrize("weight", [-127, 127])
@pytest.mark.parametrize("bias", [-32768, 32767])
@pytest.mark.parametrize("message", [-127, 127])
@pytest.mark.parametrize("state", [-16256, 16256])
def test_nothing_wraps_at_the_extremes(weight: int, bias: int, message: int, state: int) -> None:
    size = Dimensions(51, 127, 127)
    model = uniform_network(size, weight, bias)
    states = np.full((3, 51), state, dtype=np.int16)
    inputs = np.full((3, 255), message, dtype=np.int8)
    np.testing.assert_array_equal(
        core_library.update_cells(model, states, inputs), reference(model, states, inputs)
    )


def test_constants_are_those_of_the_library() -> None:
    lib = core_library.library().lib
    assert (lib.TILENCA_TICKS, lib.TILENCA_UNITS_PER_TICK * lib.TILENCA_TICKS) == (
        rollout_library.TICKS_PER_STEP,
        rollout_library.UNITS_PER_STEP,
    )
    faults = [getattr(lib, f"TILENCA_FAULT_{name.upper()}") for name in rollout_library.FAULTS]
    assert faults == list(range(len(rollout_library.FAULTS)))


WIDTHS = [16, 8, 4]


def update_by(
    lanes: int, model: Model, states: NDArray[np.int16], inputs: NDArray[np.int8]
) -> NDArray[np.int16]:
    """As many cells side by side; skips where the processor cannot."""
    try:
        return core_library.update_cells(model, states, inputs, lanes)
    except ValueError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("lanes", WIDTHS)
def test_cells_side_by_side_are_to_the_bit_what_the_chips_code_makes_of_each(
    size: Dimensions, lanes: int
) -> None:
    rng = np.random.default_rng(size.channels)
    for reach in (1, 12, 60, 127):
        model = random_network(size, reach, seed=reach)
        for count in (1, lanes - 1, lanes, 5 * lanes + 3):
            # Random values, among them the ends of their range in whole cells and here and there.
            states = rng.integers(-16256, 16257, (count, size.channels)).astype(np.int16)
            inputs = rng.integers(-127, 128, (count, 5 * size.channels)).astype(np.int8)
            states[rng.random(states.shape) < 0.2] = 16256
            states[rng.random(states.shape) < 0.2] = -16256
            inputs[rng.random(inputs.shape) < 0.2] = 127
            inputs[rng.random(inputs.shape) < 0.2] = -127
            inputs[0] = rng.choice([-127, 0, 127])
            one_by_one = core_library.update_cells(model, states, inputs, 1)
            np.testing.assert_array_equal(one_by_one, reference(model, states, inputs))
            np.testing.assert_array_equal(update_by(lanes, model, states, inputs), one_by_one)


@pytest.mark.parametrize("lanes", WIDTHS)
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_greatest_sums_there_can_be_are_exact_in_float32(lanes: int, sign: int) -> None:
    """All products have the same sign, and are odd in the end: 2^23 is near, and every unit counts."""
    size = Dimensions(51, 127, 127)
    integer = uniform_network(size, 127, 32767).integer
    rng = np.random.default_rng(4)
    integer["w3"] *= sign
    integer["w1"][:, -1] = rng.integers(-127, 128, 127)  # the sums differ in their last bits
    model = network(size, integer)
    states = rng.integers(-16256, 16257, (40, 51)).astype(np.int16)
    inputs = np.full((40, 255), 127, np.int8)
    inputs[:, -1] = rng.integers(-127, 128, 40)
    np.testing.assert_array_equal(update_by(lanes, model, states, inputs), reference(model, states, inputs))


@pytest.mark.parametrize("lanes", [-1, 2, 5, 32])
def test_a_number_of_lanes_that_no_machine_has_is_refused(lanes: int) -> None:
    model = random_network(Dimensions(4, 6, 6), 30)
    with pytest.raises(ValueError, match=f"cannot compute {lanes} cells side by side"):
        core_library.update_cells(model, np.zeros((1, 4), np.int16), np.zeros((1, 20), np.int8), lanes)


def test_any_number_of_leading_axes_and_no_change_of_the_arguments() -> None:
    model = random_network(Dimensions(4, 6, 6), 30)
    rng = np.random.default_rng(2)
    states = rng.integers(-16256, 16257, (2, 3, 5, 4)).astype(np.int16)
    inputs = rng.integers(-127, 128, (2, 3, 5, 20)).astype(np.int8)
    before = states.copy(), inputs.copy()
    together = core_library.update_cells(model, states, inputs)
    assert together.shape == states.shape
    np.testing.assert_array_equal(states, before[0])
    np.testing.assert_array_equal(inputs, before[1])
    np.testing.assert_array_equal(
        core_library.update_cells(model, states[1, 2, 3], inputs[1, 2, 3]), together[1, 2, 3]
    )
    strided = core_library.update_cells(model, states[:, ::2], inputs[:, ::2])
    np.testing.assert_array_equal(strided, together[:, ::2])


def test_no_cells_are_no_work() -> None:
    model = random_network(Dimensions(4, 6, 6), 30)
    none = core_library.update_cells(model, np.zeros((0, 4), np.int16), np.zeros((0, 20), np.int8))
    assert none.shape == (0, 4)


@pytest.mark.parametrize(
    ("states", "inputs"),
    [
        (np.zeros((3, 4), np.int32), np.zeros((3, 20), np.int8)),
        (np.zeros((3, 5), np.int16), np.zeros((3, 20), np.int8)),
        (np.zeros((3, 4), np.int16), np.zeros((3, 21), np.int8)),
        (np.zeros((3, 4), np.int16), np.zeros((2, 20), np.int8)),
        (np.zeros((3, 4), np.int16), np.zeros((3, 20), np.uint8)),
    ],
)
def test_arrays_that_do_not_fit_the_model_are_refused(
    states: NDArray[np.int16], inputs: NDArray[np.int8]
) -> None:
    model = random_network(Dimensions(4, 6, 6), 30)
    with pytest.raises(ValueError, match="need"):
        core_library.update_cells(model, states, inputs)
