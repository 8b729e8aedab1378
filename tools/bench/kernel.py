"""Cycles of the forward pass on the emulated chip: python -m bench.kernel [--write FILE].

They are exact, and the same on every machine.
"""

import argparse
import shutil
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.emulator import SOURCES
from bench.figures import exact, note
from bench.publish import publish
from firmware import kernel_program
from firmware.synthetic_models import network
from tilenca.base.paths import ROOT, SHAPES
from tilenca.emulator import Array
from tilenca.model import cost, packing
from tilenca.model.file import Dimensions, Model, load_model
from tilenca.shapes.batch import load_drawings
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator

BEGIN, END = "<!-- kernel: made by `make bench`, do not edit -->", "<!-- /kernel -->"
WIDTHS = (40, 64, 96)
TRAINED = {40: "paper", 96: "digits"}
CELLS = 48  # of a trained grid, as a sample
STEPS_YOUNG, STEPS_CONVERGED = 5, 100
MOST_S = 60
FLOAT_WIDTH = 64  # wider ones have more float weights than LPM reaches


@dataclass(frozen=True)
class Given:
    """The inputs and states of cells before an update.

    Attributes:
        inputs: (cells, 5 C) messages.
        states: (cells, C).
    """

    inputs: NDArray[np.int8]
    states: NDArray[np.int16]

    def header(self) -> str:
        """The cases in C++."""
        return "\n".join(
            [
                f"static const uint8_t kGiven = {len(self.inputs)};",
                _array("int8_t", f"kInputs[][{self.inputs.shape[1]}]", self.inputs),
                _array("int16_t", f"kStates[][{self.states.shape[1]}]", self.states),
            ]
        )


def _array(kind: str, name: str, values: NDArray[Any]) -> str:
    """A C++ array in flash, of one dimension or two."""
    braces = str.maketrans("[]", "{}")
    return f"static const {kind} {name} PROGMEM = {str(values.tolist()).translate(braces)};"


@dataclass(frozen=True)
class Cycles:
    """Cycles of one forward pass: in assembly (the mean of all cells), portable C++, and float or None."""

    assembly: float
    portable: int
    floating: int | None


def any_model(size: Dimensions, is_16_bit: bool, zeros: bool = False) -> Model:
    """Weights and biases that leave no activation at zero, with sums of 16 or of 24 bits throughout.

    With `zeros`, every other activation is zero.
    """
    random = np.random.default_rng(0)
    integer: dict[str, NDArray[Any]] = {}
    for name, shape in size.shapes().items():
        if name.startswith("b"):
            integer[name] = np.full(shape, 8000 if is_16_bit else 32767, np.int16)
            integer[name][1 if zeros else shape[0] :: 2] *= -1
        else:
            weights = random.integers(-1, 2, shape) if is_16_bit else random.integers(1, 21, shape)
            integer[name] = weights.astype(np.int8)
    if not is_16_bit:
        integer["w1"] *= random.choice(np.array([-1, 1], np.int8), integer["w1"].shape)
    model = network(size, integer)
    assert {one.is_16_bit for layer in (1, 2, 3) for one in packing.blocks(model, layer)} == {is_16_bit}
    return model


def dense(size: Dimensions, zeros: bool = False) -> Given:
    """One cell without zero messages, or with every other one zero; half of the rest are negative."""
    random = np.random.default_rng(1)
    sizes = random.integers(1, 128, (1, 5 * size.channels))
    signs = random.choice([-1, 1], sizes.shape)
    sizes[:, 1 if zeros else sizes.shape[1] :: 2] = 0
    return Given((sizes * signs).astype(np.int8), np.zeros((1, size.channels), np.int16))


def trained_cells(model: Model, steps: int) -> Given:
    """Some cells of the ten digits after some steps on the clocks of real tiles."""
    drawings = load_drawings([SHAPES / "digits.toml"], labels=model.labels)
    random = np.random.default_rng(2)
    engine = FastEngine(model)
    simulator = Simulator(engine, drawings, np.arange(len(drawings)), Conditions("clock"), random, threads=1)
    simulator.run(steps)
    messages = engine.message(simulator.states)
    known = np.vstack([messages, np.zeros_like(messages[:1])])
    inputs = np.hstack([messages, *(known[simulator.batch.neighbours[:, side]] for side in range(4))])
    chosen = random.choice(len(inputs), CELLS, replace=False)
    return Given(inputs[chosen], simulator.states[chosen])


def measure(model: Model, given: Given, with_float: bool = False) -> Cycles:
    """Runs forward passes on the emulated chip."""
    with tempfile.TemporaryDirectory() as directory:
        folder = Path(directory)
        lines = [given.header()]
        if with_float:
            lines += [
                _array("float", f"kFloat{name.upper()}[]", array.ravel())
                for name, array in model.floats.items()
            ]
        folder.joinpath("given.h").write_text("\n".join(lines), encoding="utf-8")
        options = [f"-I{folder}", *(["-DFLOATS"] if with_float else [])]
        elf = kernel_program.program(model, SOURCES / "kernel.cpp", folder, *options)
        with Array(elf) as array:
            tile = array[0]
            tile.mark("begins")
            tile.mark("finish")
            for _ in range(MOST_S):
                array.run(0.1)
                if tile.integer("done"):
                    break
            marks = tile.marks()
    begun, finished = (np.array([mark.cycle for mark in marks[first::2]]) for first in (0, 1))
    took = finished - begun
    cells = len(given.inputs)
    return Cycles(float(took[:cells].mean()), int(took[cells]), int(took[-1]) if with_float else None)


def row(what: str, size: Dimensions, found: Cycles) -> tuple[str, ...]:
    """A line of the table."""
    count = cost.macs(size)
    note(exact(f"kernel: {what.replace('`', '')}", found.assembly, "cycles"))
    floating = "" if found.floating is None else f"{found.floating / count:.0f}"
    return (
        what,
        f"{found.assembly:,.0f}",
        f"{found.assembly / 16000:.2f}",
        f"**{found.assembly / count:.2f}**",
        f"{found.portable / count:.1f}",
        floating,
    )


def rows() -> list[tuple[str, ...]]:
    """All lines of the table."""
    found = []
    for width in WIDTHS:
        size = Dimensions(21, width, width)
        for is_16_bit in (False, True):
            what = f"hidden {width}, sums of {16 if is_16_bit else 24} bits, nothing is zero"
            with_float = not is_16_bit and width <= FLOAT_WIDTH
            found.append(row(what, size, measure(any_model(size, is_16_bit), dense(size), with_float)))
        what = f"hidden {width}, sums of 16 bits, every other value is zero"
        found.append(row(what, size, measure(any_model(size, True, zeros=True), dense(size, zeros=True))))
        if width in TRAINED:
            model = load_model(ROOT / "models" / TRAINED[width])
            for name, steps in (("young", STEPS_YOUNG), ("converged", STEPS_CONVERGED)):
                what = f"hidden {width}, `models/{TRAINED[width]}`, {name} grid"
                found.append(row(what, size, measure(model, trained_cells(model, steps))))
    return found


def table(lines: Sequence[Sequence[str]]) -> str:
    """The rows in Markdown."""
    head = ["forward pass", "cycles", "ms", "cycles per MAC", "portable C++", "float C++"]
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *lines])


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="Cycles of the forward pass on the chip.")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    args = parser.parse_args()
    if shutil.which("avr-gcc") is None:
        print("bench: avr-gcc is not installed; the kernel is not measured", file=sys.stderr)
        return 0
    section = table(rows())
    publish(section, args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
