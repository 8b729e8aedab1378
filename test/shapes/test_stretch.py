"""Drawings at other sizes: lines get longer, not thicker."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.base import paths
from tilenca.shapes.cells import cells_of, connected
from tilenca.shapes.edits import rows_of
from tilenca.shapes.file import load_task
from tilenca.shapes.stretch import Extent, Rows, smallest, stretch

DIGITS = {shape.label: shape.rows for shape in load_task(paths.DEFAULT_SHAPES).shapes}
sizes = st.tuples(st.integers(5, 24), st.integers(3, 24))


def drawn(*rows: str) -> Rows:
    return rows


def test_the_digits_stretched_are_those_drawn_by_hand() -> None:
    for shape in load_task(paths.SHAPES / "digits-7x6.toml").shapes:
        assert stretch(DIGITS[shape.label], 7, 6) == shape.rows, shape.label


def test_the_digits_that_keep_their_form_shrink_to_those_drawn_by_hand() -> None:
    by_hand = {shape.name: shape.rows for shape in load_task(paths.SHAPES / "digits-3x3.toml").shapes}
    for label in "0147":
        assert stretch(DIGITS[label], 3, 3) == by_hand[label], label


@pytest.mark.parametrize("label", ["2", "3", "5", "6", "8", "9"])
def test_a_drawing_with_more_strokes_than_rows_cannot_be_drawn(label: str) -> None:
    assert stretch(DIGITS[label], 3, 3) is None


@given(st.sampled_from(sorted(DIGITS)), sizes, st.booleans())
def test_a_stretched_drawing_has_its_size_hangs_together_and_shrinks_to_the_same(
    label: str, size: tuple[int, int], up: bool
) -> None:
    rows = stretch(DIGITS[label], *size, up)
    assert rows is not None
    assert len(rows) == size[0]
    assert {len(row) for row in rows} == ({1} if label == "1" else {size[1]})
    assert connected(cells_of(rows))
    assert smallest(rows) == smallest(DIGITS[label])


def test_a_filled_area_stays_filled_and_a_line_stays_thin() -> None:
    assert stretch(drawn("##", "##"), 3, 4) == drawn("####", "####", "####")
    assert stretch(drawn("#.", "##"), 3, 4) == drawn("#...", "#...", "####")


def test_a_line_has_no_width() -> None:
    assert stretch(drawn("#", "#", "#"), 5, 4) == ("#",) * 5
    assert stretch(drawn("###"), 5, 4) == ("####",)


def test_what_lies_half_way_goes_up_or_down_as_asked() -> None:
    three = DIGITS["3"]
    low, high = stretch(three, 6, 4, up=True), stretch(three, 6, 4, up=False)
    assert low is not None
    assert high is not None
    assert [row == "####" for row in low] == [True, False, False, True, False, True]
    assert [row == "####" for row in high] == [True, False, True, False, False, True]


def test_a_single_tile_has_no_size() -> None:
    assert stretch(drawn("#"), 5, 4) == ("#",)


@given(st.sampled_from(sorted(DIGITS)), sizes, st.integers(0, 10_000))
def test_an_extent_less_a_tile_is_that_of_the_drawing_less_that_tile(
    label: str, size: tuple[int, int], choice: int
) -> None:
    rows = stretch(DIGITS[label], *size)
    assert rows is not None
    extent = Extent(rows)
    small = smallest(rows)
    assert extent.whole == (len(small), len(small[0]))
    cells = cells_of(rows)
    gone = cells[choice % len(cells)]
    less = smallest(rows_of(cell for cell in cells if cell != gone))
    assert extent.without(*gone) == (len(less), len(less[0]))
    assert extent.is_near((len(less), len(less[0])))
