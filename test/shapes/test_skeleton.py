"""Skeletons of drawings and of strokes."""

from itertools import pairwise

import numpy as np
import pytest

from tilenca.shapes.skeleton import of_rows, of_strokes


def test_a_drawing_becomes_strokes_between_its_corners_ends_and_junctions() -> None:
    four = of_rows(("#..#", "#..#", "####", "...#", "...#"))
    assert sorted(map(tuple, four.points.tolist())) == [(0, 0), (0, 2), (3, 0), (3, 2), (3, 4)]
    assert (len(four.edges), four.holes, len(four.fills)) == (4, 0, 0)
    assert len(four.ends) == 3
    assert sorted(len(path) for path in four.paths) == [2, 2, 3]


@pytest.mark.parametrize(
    ("rows", "holes"),
    [
        (("###", "#.#", "###"), 1),
        (("####", "#..#", "####", "#..#", "####"), 2),
        (("##", "##"), 0),
        (("##.", "###", ".##"), 0),
        (("###", "###", "###"), 0),
        (("#",), 0),
    ],
)
def test_holes_are_counted_and_blocks_are_filled(rows: tuple[str, ...], holes: int) -> None:
    assert of_rows(rows).holes == holes


def test_a_closed_stroke_is_one_path_that_ends_where_it_began() -> None:
    (path,) = of_rows(("###", "#.#", "###")).paths
    assert path[0] == path[-1]
    assert len(path) == 5


def test_strokes_are_joined_where_they_touch_and_where_they_cross() -> None:
    cross = of_strokes([[(0, 0.5), (1, 0.5)], [(0.5, 0), (0.5, 1)]])
    assert len(cross.points) == 5
    assert sorted(cross.degree) == [1, 1, 1, 1, 4]
    touching = of_strokes([[(0, 0), (0, 1)], [(0, 0.5), (1, 0.5)]])
    assert len(touching.edges) == 3
    assert of_strokes([[(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]]).holes == 1


@pytest.mark.parametrize(
    ("strokes", "what"),
    [([[(0.0, 0.0)]], "two points"), ([[(0.0, 0.0), (1.0, 0.0)], [(0.0, 1.0), (1.0, 1.0)]], "not connected")],
)
def test_strokes_that_make_no_drawing_are_refused(
    strokes: list[list[tuple[float, float]]], what: str
) -> None:
    with pytest.raises(ValueError, match=what):
        of_strokes(strokes)


def test_every_stroke_of_a_path_is_an_edge_and_every_edge_lies_on_one_path() -> None:
    eight = of_rows(("####", "#..#", "####", "#..#", "####"))
    walked = [tuple(sorted(pair)) for path in eight.paths for pair in pairwise(path)]
    assert sorted(walked) == sorted(eight.edges)
    assert np.isfinite(eight.points).all()
