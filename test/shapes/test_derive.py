"""Shapes derived from a task's shapes, for training and for test suites."""

from collections.abc import Callable

import numpy as np
import pytest

from tilenca.shapes import edits
from tilenca.shapes.derive import at_size, at_sizes, damaged, draw_unknown, known_of
from tilenca.shapes.file import Shape
from tilenca.shapes.stretch import Rows, smallest
from tilenca.shapes.variant import CHOOSING, LAST, TRAINED, split_of

ONE, SEVEN = Shape("1", ("#", "#", "#"), "1"), Shape("7", ("###", "..#", "..#"), "7")
TASK = [ONE, SEVEN]
SPLITS = (TRAINED, CHOOSING, LAST)


def strokes(seed: int = 1) -> Callable[[], Rows | None]:
    return edits.some_strokes([("###", "#.#", "###", "#.#", "###")], np.random.default_rng(seed))


def test_shapes_at_another_size_leave_out_those_that_cannot_be_drawn_that_small() -> None:
    assert [shape.rows for shape in at_size(TASK, (2, 2))] == [("#", "#"), ("##", ".#")]
    u = Shape("U", ("#.#", "#.#", "###"), "U")
    assert at_size([ONE, u], (2, 2)) == at_size([ONE], (2, 2))


def test_every_size_comes_rounded_up_and_rounded_down() -> None:
    letter = Shape("F", ("##", "#.", "##", "#."), "F")
    up, down = at_sizes([letter], [(5, 2)])
    assert (up, down) == (at_size([letter], (5, 2), up=True), at_size([letter], (5, 2), up=False))


def test_a_damaged_shape_keeps_its_label_and_looks_like_no_other() -> None:
    zero = Shape("0", ("###", "#.#", "###"), "0")
    known = known_of([zero, *TASK])
    found = [shape for split in SPLITS for shape in damaged([zero, SEVEN], known, " less one", split)]
    assert {(shape.label, shape.name) for shape in found} == {("0", "0 less one")}, "a short 7 is still a 7"
    assert len(found) == 8, "every tile of a ring can go"


@pytest.mark.parametrize("split", SPLITS)
def test_drawings_of_no_class_are_on_one_side_of_the_split_and_never_known(split: str) -> None:
    known = known_of(TASK)
    found = draw_unknown(20, strokes(), known, split)
    assert found
    assert len(set(found)) == len(found)
    for rows in found:
        assert split_of(rows) == split
        assert not known.is_known(rows)


def test_doubtful_drawings_are_excluded_at_every_size() -> None:
    known = known_of(TASK)
    first, *others = draw_unknown(1000, strokes(), known, TRAINED)
    without = draw_unknown(1000, strokes(), known, TRAINED, {smallest(first)})
    assert without == [rows for rows in others if smallest(rows) != smallest(first)]
