"""Where a tile is missing: found where there is no doubt, and only there."""

import numpy as np

from tilenca.base import paths
from tilenca.base.sides import OFFSETS
from tilenca.shapes.batch import load_drawings
from tilenca.shapes.edits import rows_of
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.gaps import Gaps


def shape(label: str, *rows: str) -> Shape:
    return Shape(label, rows, label)


L, U = shape("L", "#..", "#..", "###"), shape("U", "#.#", "#.#", "###")
GAPS = Gaps([L, U])


def test_whole_drawings_miss_nothing() -> None:
    for whole in (L, U):
        sides = GAPS.sides(whole)
        assert sides is not None
        assert sides.shape == (len(whole.cells), 4)
        assert not sides.any()
        assert GAPS.missing(whole) is None


def test_the_tile_before_the_gap_has_its_side() -> None:
    """A U without the upper right tile: the one below it lacks its north neighbour, nobody else does."""
    less = shape("U", "#..", "#.#", "###")
    assert GAPS.missing(less) == (U.rows, (0, 2))
    sides = GAPS.sides(less)
    assert sides is not None
    assert np.argwhere(sides).tolist() == [[less.cells.index((1, 2)), 0]]


def test_the_gap_may_lie_outside_of_what_is_left() -> None:
    """A T without its foot: the row of the foot is gone."""
    tee = shape("t", "###", ".#.", "##.")
    less = shape("t", "###", ".#.", ".#.")
    assert Gaps([tee]).missing(less) == (tee.rows, (2, 0))
    beam, crossed = shape("T", "#.#", "###"), shape("T", "###")
    assert Gaps([beam]).missing(crossed) is None, "two tiles are missing"


def test_what_leaves_a_doubt_is_not_known() -> None:
    """An L may be an L of another length; one that two drawings share may be either."""
    assert GAPS.missing(shape("L", "#..", "###")) is None, "an L at another size"
    assert GAPS.sides(shape("L", "#..", "###")) is None
    one, other = shape("a", "###", "#.#"), shape("b", "###", "##.")
    assert Gaps([one, other]).sides(shape("a", "###", "#..")) is None
    assert GAPS.sides(shape(UNKNOWN, "####", "#...")) is None


def test_the_same_tiles_with_a_gap_at_either_end_are_a_doubt() -> None:
    line = shape("1", "#", "#", "#", "#")
    assert Gaps([line, shape("L", "#.", "##")]).damaged([line]) == []


def test_a_drawing_of_another_class_is_not_told_what_is_missing() -> None:
    assert GAPS.sides(shape("L", "#..", "#.#", "###")) is None


def test_all_damaged_digits_are_mended_by_the_tile_they_miss() -> None:
    """Of 64 tiles that may be missing, most leave no doubt, and the tile put back gives the whole digit."""
    task = load_drawings([paths.DEFAULT_SHAPES])
    gaps = Gaps(task.shapes)
    less = gaps.damaged(task.shapes)
    assert 50 <= len(less) < 64
    for damaged in less:
        found = gaps.missing(damaged)
        assert found is not None
        whole, gap = found
        assert rows_of([*damaged.cells, gap]) == whole
        sides = gaps.sides(damaged)
        assert sides is not None
        beside = [
            side
            for (row, col), says in zip(damaged.cells, sides, strict=True)
            for side, (dr, dc) in enumerate(OFFSETS)
            if says[side] and (row + dr, col + dc) == gap
        ]
        assert len(beside) == sides.sum() > 0
