"""Held-out drawings run twice, on emulated tiles and in the simulator; they come from all over a file."""

import argparse
import math
from pathlib import Path

import numpy as np
import pytest

from bench import unseen
from bench.pairs import Pairs
from tilenca.base import paths
from tilenca.shapes.batch import load_drawings


def test_the_drawings_come_from_all_over_the_file() -> None:
    ten = load_drawings([paths.SHAPES / "digits.toml"])
    five = unseen.some(ten, 5)
    assert [shape.label for shape in five.shapes] == ["0", "2", "4", "6", "8"]
    assert unseen.some(ten, 50).shapes == ten.shapes


def test_a_row_counts_where_the_two_differ() -> None:
    drawings = unseen.some(load_drawings([paths.SHAPES / "digits.toml"]), 4)
    never = math.inf
    pairs = Pairs(np.array([9.0, never, never, 30.0]), np.array([12.0, 20.0, never, never]))
    right = "0.500 (0.150 to 0.850)"
    assert (
        unseen.row("mine", drawings, pairs) == f"| `mine` | 4 | 9 to 14 | {right} | {right} | 0.500 | 1, 1 |"
    )


@pytest.mark.parametrize("text", ["digits", "=a", "digits=", "digits=/no/such/file"])
def test_what_is_asked_names_a_model_and_a_file(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="MODEL=FILE"):
        unseen.asked(text)


def test_both_name_a_digit_that_both_know(firmware: Path) -> None:
    file = paths.SHAPES / "digits-3x3.toml"
    assert firmware.is_file()
    line = unseen.measure(unseen.Asked("digits", file), 2, 60, 1)
    assert line.endswith("| 1.000 | 0, 0 |")
    assert line.count("1.000 (0.342 to 1.000)") == 2
