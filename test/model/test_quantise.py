"""Integers: rounding, and that PyTorch and the firmware's core agree in every bit of every state."""

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from support.integer_network import IntegerEngine, IntegerNet
from tilenca.base import paths
from tilenca.model.file import LARGEST, SCALES, Dimensions, Model, load_model
from tilenca.model.quantise import quantise
from tilenca.shapes.batch import load_drawings
from tilenca.simulator import core_library
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.training.float_engine import FloatEngine
from tilenca.training.network import TileNet

needs_core = pytest.mark.skipif(
    not core_library.LIBRARY.exists(), reason="run `make setup` to compile the core"
)
FILES = [paths.SHAPES / name for name in ("digits.toml", "digits-3x3.toml", "digits-7x6.toml")]


def random_model(dimensions: Dimensions, seed: int, extreme: bool) -> Model:
    """Weights anywhere in range, or all at its ends."""
    random = np.random.default_rng(seed)
    floats = {}
    for name, shape in dimensions.shapes().items():
        size = random.uniform(-1, 1, shape)
        floats[name] = ((np.sign(size) if extreme else size) * LARGEST[name] / SCALES[name]).astype(
            np.float32
        )
    return quantise(dimensions, ("0", "1"), floats, {})[0]


def test_rounding_goes_to_the_nearest_step_and_halves_go_up() -> None:
    dimensions = Dimensions(3, 1, 1)
    floats = {name: np.zeros(shape, np.float32) for name, shape in dimensions.shapes().items()}
    floats["w1"][0, :5] = np.array([0.5, -0.5, 1.49, -1.51, 126.6]) / 64
    floats["b3"][:] = np.array([1.0, -2.5, 0.4]) / 8192
    model, cut = quantise(dimensions, ("0", "1"), floats, {})
    assert model.integer["w1"][0, :5].tolist() == [1, 0, 1, -2, 127]
    assert model.integer["b3"].tolist() == [1, -2, 0]
    assert cut == 0


def test_weights_out_of_range_are_cut_and_counted() -> None:
    dimensions = Dimensions(3, 1, 1)
    floats = {name: np.zeros(shape, np.float32) for name, shape in dimensions.shapes().items()}
    floats["w2"][0, 0], floats["w3"][1, 0], floats["b1"][0] = 2.0, -1.1, 9.0
    model, cut = quantise(dimensions, ("0", "1"), floats, {})
    assert (model.integer["w2"][0, 0], model.integer["w3"][1, 0], model.integer["b1"][0]) == (
        127,
        -127,
        32767,
    )
    assert cut == 3


def slow_update(model: Model, state: NDArray[np.int16], seen: NDArray[np.int8]) -> list[int]:
    """docs/PROTOCOL.md section 4 for one cell in Python's whole numbers, which cannot wrap."""
    arrays = {name: model.integer[name].tolist() for name in model.integer}
    values = [int(value) for value in seen]
    for layer in "12":
        sums = [
            bias + sum(weight * value for weight, value in zip(row, values, strict=True))
            for row, bias in zip(arrays[f"w{layer}"], arrays[f"b{layer}"], strict=True)
        ]
        values = [min(max((total + 32) >> 6, 0), 127) for total in sums]
    changes = [
        bias + sum(weight * value for weight, value in zip(row, values, strict=True))
        for row, bias in zip(arrays["w3"], arrays["b3"], strict=True)
    ]
    return [min(max(int(old) + change, -16256), 16256) for old, change in zip(state, changes, strict=True)]


@pytest.mark.parametrize("extreme", [False, True])
@pytest.mark.parametrize(
    "dimensions", [Dimensions(21, 40, 40), Dimensions(3, 1, 2), Dimensions(51, 127, 127)]
)
def test_the_integer_net_is_the_protocol_to_the_bit(dimensions: Dimensions, extreme: bool) -> None:
    model = random_model(dimensions, 4, extreme)
    random = np.random.default_rng(5)
    states = random.integers(-16256, 16257, (12, dimensions.channels)).astype(np.int16)
    seen = random.integers(-127, 128, (12, 5 * dimensions.channels)).astype(np.int8)
    seen[0], seen[1] = 127, -127
    got = IntegerNet(model).update(torch.from_numpy(states), torch.from_numpy(seen)).numpy()
    for cell in range(len(states)):
        assert got[cell].tolist() == slow_update(model, states[cell], seen[cell])


@needs_core
@pytest.mark.parametrize("extreme", [False, True])
@pytest.mark.parametrize(
    "dimensions", [Dimensions(21, 40, 40), Dimensions(3, 1, 2), Dimensions(51, 127, 127)]
)
def test_the_firmware_core_and_pytorch_agree_on_any_weights(dimensions: Dimensions, extreme: bool) -> None:
    random = np.random.default_rng(6)
    for seed in range(5):
        model = random_model(dimensions, seed, extreme)
        states = random.integers(-16256, 16257, (200, dimensions.channels)).astype(np.int16)
        seen = random.integers(-127, 128, (200, 5 * dimensions.channels)).astype(np.int8)
        mine = IntegerNet(model).update(torch.from_numpy(states), torch.from_numpy(seen)).numpy()
        assert np.array_equal(core_library.update_cells(model, states, seen), mine)


@needs_core
@pytest.mark.parametrize("schedule", ["random", "clock"])
def test_core_and_pytorch_agree_over_long_lives_of_the_shipped_model(schedule: str) -> None:
    model = load_model(paths.DEFAULT_MODEL)
    drawings = load_drawings(FILES, labels=model.labels)
    conditions = Conditions("random" if schedule == "random" else "clock", loss=0.1)
    chosen = np.arange(len(drawings))
    engines = FastEngine(model), IntegerEngine(model), FloatEngine(model)
    runs = [Simulator(engine, drawings, chosen, conditions, np.random.default_rng(8)) for engine in engines]
    for part in range(10):
        for run in runs:
            run.run(25)
        fast, integer, trained = (run.states for run in runs)
        assert np.array_equal(fast, integer), f"step {25 * part + 25}"
        # What training computed in float32 is the same number in another unit.
        assert np.array_equal(fast, trained * 128), f"step {25 * part + 25}"


def test_a_net_in_training_computes_what_its_integer_twin_will() -> None:
    random = np.random.default_rng(9)
    model = random_model(Dimensions(21, 40, 40), 9, extreme=False)
    net = TileNet(model.dimensions, True, model.floats)
    states = random.integers(-16256, 16257, (500, 21)).astype(np.int16)
    seen = random.integers(-127, 128, (500, 105)).astype(np.int8)
    inputs = torch.from_numpy(states / np.float32(128)), torch.from_numpy(seen.astype(np.float32))
    trained = net.update(*inputs, torch.ones(500, 1), net.weights()).detach().numpy()
    exact = IntegerNet(model).update(torch.from_numpy(states), torch.from_numpy(seen)).numpy()
    assert np.array_equal(trained * 128, exact)
