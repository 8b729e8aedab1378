"""The forward pass in assembly, against the portable C++ compiled for the chip and against numpy."""

from pathlib import Path

import numpy as np
import pytest

from bench import kernel
from firmware import kernel_program, stack
from firmware.disassembly import disassemble, parse
from firmware.synthetic_models import random_network, uniform_network
from tilenca.base.paths import ROOT
from tilenca.emulator import Array, EmulatedTile
from tilenca.model import cost, packing
from tilenca.model.file import Dimensions, Model, load_model

DRIVER = Path(__file__).with_name("kernel.cpp")
MOST_S = 200


def run(model: Model, folder: Path, vectors: int, *options: str) -> EmulatedTile:
    elf = kernel_program.program(model, DRIVER, folder, f"-DVECTORS={vectors}", *options)
    array = Array(elf)
    for _ in range(MOST_S):
        array.run(1.0)
        if array[0].integer("done"):
            break
    tile = array[0]
    assert tile.fault == ""
    assert tile.integer("vectors") == vectors
    assert tile.integer("calls") > 0
    return tile


SIZES = [
    Dimensions(21, 40, 40),
    Dimensions(21, 64, 64),
    Dimensions(21, 96, 96),
    Dimensions(2, 1, 1),
    Dimensions(3, 9, 7),
    Dimensions(8, 16, 8),
    Dimensions(51, 120, 127),
    Dimensions(50, 127, 120),
]


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_every_block_is_that_of_the_portable_code(size: Dimensions, tmp_path: Path) -> None:
    vectors = min(3000, 6_000_000 // (size.hidden1 * size.channels * 5 + size.hidden1 * size.hidden2))
    tile = run(random_network(size, 127, 32767), tmp_path, vectors)
    assert tile.integer("differences") == 0
    assert tile.integer("zero_outputs") > 0
    assert tile.integer("full_outputs") > 0
    assert tile.integer("full_states") > 0
    if size.hidden1 >= 40:
        assert tile.integer("blocks_of_24_bits") == tile.integer("calls")


@pytest.mark.parametrize(
    ("size", "reach"),
    [(Dimensions(21, 40, 40), 4), (Dimensions(5, 12, 20), 8), (Dimensions(51, 16, 8), 1)],
    ids=str,
)
def test_sums_of_16_bits_reach_both_ends_and_do_not_wrap(
    size: Dimensions, reach: int, tmp_path: Path
) -> None:
    """Weights just small enough: the drawn inputs along a row's signs make its sum the greatest there is."""
    model = random_network(size, reach, 100)
    for layer in (1, 2, 3):
        weights, biases = model.integer[f"w{layer}"], model.integer[f"b{layer}"]
        low, high = (
            (np.minimum(weights, 0), np.maximum(weights, 0)) if layer > 1 else (-abs(weights), abs(weights))
        )
        upward = np.arange(len(biases)) % 2 == 0
        most, least = 127 * high.sum(axis=1, dtype=int), 127 * low.sum(axis=1, dtype=int)
        rounding = packing.ROUNDING if layer < 3 else 0
        biases[:] = np.clip(np.where(upward, 32767 - most, -32768 - least) - rounding, -32768, 32767)
    for layer in (1, 2, 3):
        parts = packing.blocks(model, layer)
        assert all(part.is_16_bit for part in parts)
        assert max(part.most for part in parts) == 32767
        assert min(part.least for part in parts) == -32768
    tile = run(model, tmp_path, 1000)
    assert tile.integer("blocks_of_24_bits") == 0
    assert tile.integer("differences") == 0
    assert tile.integer("zero_outputs") > 0
    assert tile.integer("full_outputs") > 0
    assert tile.integer("full_states") > 0


@pytest.mark.parametrize("first", [0, 1])
def test_blocks_of_both_kinds_take_turns(first: int, tmp_path: Path) -> None:
    """Within a layer, and within a call."""
    model = random_network(Dimensions(21, 40, 40), 127, 100)
    for layer in (1, 2, 3):
        is_16_bit = np.arange(len(model.integer[f"b{layer}"])) // packing.BLOCK_OUTPUTS % 2 == first
        model.integer[f"w{layer}"][is_16_bit] //= 64
        kinds = [part.is_16_bit for part in packing.blocks(model, layer)]
        assert kinds == list(is_16_bit[:: packing.BLOCK_OUTPUTS])
    tile = run(model, tmp_path, 1000)
    assert tile.integer("blocks_of_24_bits") > 0
    assert tile.integer("differences") == 0


@pytest.mark.parametrize("weight", [-127, 0, 127])
@pytest.mark.parametrize("bias", [-32768, 32767])
def test_nothing_wraps_at_the_extremes(weight: int, bias: int, tmp_path: Path) -> None:
    size = Dimensions(51, 120, 127)
    tile = run(uniform_network(size, weight, bias), tmp_path, 60)
    assert tile.integer("differences") == 0


@pytest.mark.parametrize("reach", [3, 127])
def test_interrupts_between_any_two_instructions_change_nothing(reach: int, tmp_path: Path) -> None:
    """They multiply, read flash, and come at random, as often as the chip can bear."""
    tile = run(random_network(Dimensions(21, 40, 40), reach, 100), tmp_path, 300, "-DHOSTILE")
    assert tile.integer("interrupts") > 10_000
    assert (tile.integer("blocks_of_24_bits") == 0) == (reach == 3)
    assert tile.integer("differences") == 0


def test_the_shipped_model_on_the_chip_is_numpy(tmp_path: Path) -> None:
    """The last vector of the last layer, to be sure that both kernels do not err alike."""
    model = load_model(ROOT / "models" / "digits")
    tile = run(model, tmp_path, 200)
    assert tile.integer("differences") == 0
    size = model.dimensions

    def array(name: str, count: int, kind: type) -> np.ndarray:
        return np.frombuffer(tile.variable(name)[: count * np.dtype(kind).itemsize], kind)

    inputs = array("inputs", size.hidden2, np.int8).astype(int)
    sums = (
        array("start_states", size.channels, np.int16)
        + model.integer["w3"].astype(int) @ inputs
        + model.integer["b3"]
    )
    np.testing.assert_array_equal(array("states", size.channels, np.int16), np.clip(sums, -16256, 16256))


def test_the_kernel_needs_33_bytes_of_stack(tmp_path: Path) -> None:
    elf = kernel_program.program(
        random_network(Dimensions(21, 40, 40), 1, 1), DRIVER, tmp_path, "-DVECTORS=1"
    )
    listing = parse(disassemble(elf))
    found = stack.StackAnalysis(listing).depth(listing.functions["tilenca_blocks"])
    assert found + stack.RETURN_ADDRESS == 33


@pytest.mark.parametrize("width", kernel.WIDTHS)
def test_cycles_of_a_forward_pass_without_a_zero(width: int) -> None:
    size = Dimensions(21, width, width)
    found = kernel.measure(kernel.any_model(size, is_16_bit=False), kernel.dense(size))
    assert found.assembly <= 9.7 * cost.macs(size)
    found = kernel.measure(kernel.any_model(size, is_16_bit=True), kernel.dense(size))
    assert found.assembly <= 8.2 * cost.macs(size)
    half = kernel.any_model(size, is_16_bit=True, zeros=True)
    found = kernel.measure(half, kernel.dense(size, zeros=True))
    assert found.assembly <= 5 * cost.macs(size)


@pytest.mark.parametrize("steps", [kernel.STEPS_YOUNG, kernel.STEPS_CONVERGED])
@pytest.mark.parametrize("name", ["digits", "paper"])
def test_cycles_of_a_forward_pass_in_a_tissue(name: str, steps: int) -> None:
    model = load_model(ROOT / "models" / name)
    found = kernel.measure(model, kernel.trained_cells(model, steps))
    assert found.assembly <= 6.3 * cost.macs(model.dimensions)
