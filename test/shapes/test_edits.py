"""Drawings made from drawings: damage that leaves no doubt, and what belongs to no class."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.base import paths
from tilenca.shapes import edits
from tilenca.shapes.cells import cells_of, connected
from tilenca.shapes.edits import Known
from tilenca.shapes.file import load_task
from tilenca.shapes.stretch import Rows, smallest, stretch

SHAPES = load_task(paths.DEFAULT_SHAPES).shapes
DIGITS = {shape.label: shape.rows for shape in SHAPES}
KNOWN = Known((shape.label, shape.rows) for shape in SHAPES)
SEGMENTS = edits.segments([shape.rows for shape in SHAPES])


def test_damage_that_makes_another_digit_is_left_out() -> None:
    eight = KNOWN.damaged("8", DIGITS["8"])
    assert DIGITS["6"] not in eight
    assert DIGITS["9"] not in eight
    assert len(eight) == 16 - 2
    assert all(sum(row.count("#") for row in rows) == 15 for rows in eight)


def test_damage_that_two_digits_share_is_left_out() -> None:
    task = Known([("L", ("#..", "###")), ("J", ("..#", "###"))])
    assert ("###",) not in task.damaged("L", ("#..", "###"))
    assert ("##",) not in task.damaged("L", ("#..", "###"))


def test_labels_that_look_alike_when_damaged_are_named() -> None:
    assert KNOWN.lookalikes() == {"6": ["5"], "8": ["6", "9"], "9": ["3", "5"]}


def test_a_digit_is_known_at_any_size_and_with_one_tile_too_many_or_missing() -> None:
    for label, rows in DIGITS.items():
        for size in ((5, 4), (9, 7), (14, 12)):
            grown = stretch(rows, *size)
            assert grown is not None
            assert KNOWN.is_known(grown), label
    for less in edits.without_one(DIGITS["2"]):
        assert KNOWN.is_known(less)
    assert KNOWN.is_known(("####", "...#", "####", "#..#", "####")), "a 2 with a tile too many"
    assert not KNOWN.is_known(("####", "#...", "####", "#...", "#...")), "an F is no digit"


def test_the_segments_of_the_digits_are_the_seven_of_the_display() -> None:
    assert len(SEGMENTS) == 7
    assert sorted(len(stroke) for stroke in SEGMENTS) == [3, 3, 3, 3, 4, 4, 4]


@given(st.integers(0, 2**32 - 1), st.integers(1, 24))
def test_random_drawings_hang_together_and_have_their_number_of_tiles(seed: int, tiles: int) -> None:
    rows = edits.grown(np.random.default_rng(seed), tiles, 5, 6)
    assert connected(cells_of(rows))
    assert len(cells_of(rows)) == tiles
    assert len(rows) <= 5
    assert len(rows[0]) <= 6


@given(st.integers(0, 2**32 - 1), st.sampled_from(sorted(DIGITS)))
def test_a_half_is_a_connected_half(seed: int, label: str) -> None:
    rows = edits.half(np.random.default_rng(seed), DIGITS[label])
    assert connected(cells_of(rows))
    assert len(cells_of(rows)) == len(cells_of(DIGITS[label])) // 2


@given(st.integers(0, 2**32 - 1))
def test_choices_of_strokes_and_edited_drawings_hang_together(seed: int) -> None:
    random = np.random.default_rng(seed)
    for rows in (edits.some_segments(random, SEGMENTS), edits.edited(random, DIGITS["5"], 3)):
        assert rows is None or connected(cells_of(rows))


def test_drawing_ends_where_there_are_no_more_drawings() -> None:
    random = np.random.default_rng(1)
    found = edits.draw_until(
        1000, lambda: edits.some_segments(random, SEGMENTS), lambda rows: not KNOWN.is_known(rows)
    )
    assert len(found) == len(set(found)) == 43  # all there are


@given(st.integers(0, 2**32 - 1), st.integers(1, 60))
def test_what_is_known_of_large_drawings_is_what_drawing_all_their_relatives_says(
    seed: int, tiles: int
) -> None:
    random = np.random.default_rng(seed)
    rows = edits.grown(random, tiles, 9, 9)
    whole = edits.grown(random, tiles, 8, 8) if seed % 2 else rows
    known = Known([("A", whole), ("L", ("#.", "##"))])
    relatives = [smallest(less) for less in edits.without_one(rows)]
    touched = rows in [*edits.without_one(whole), *edits.without_one(("#.", "##"))]
    same = smallest(rows) in known.forms
    assert known.is_known(rows) == (touched or same or any(less in known.forms for less in relatives))
    others = {known.forms[less] for less in relatives if less in known.forms} - {"A"}
    if rows == whole:
        assert known.lookalikes().get("A", []) == sorted(others)


def test_the_largest_drawing_is_compared_with_few_relatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """A block of 15 x 17 tiles has 255 relatives; drawing each of them for each comparison took minutes."""
    drawn: list[Rows] = []

    def counted(rows: Rows) -> Rows:
        drawn.append(rows)
        return smallest(rows)

    monkeypatch.setattr(edits, "smallest", counted)
    known = Known([("0", ("#" * 17,) * 15), ("L", ("#..", "#..", "###"))])
    random = np.random.default_rng(1)
    drawn.clear()
    for _ in range(20):
        known.is_known(edits.grown(random, 255, 18, 16))
    assert len(drawn) < 3 * 20
