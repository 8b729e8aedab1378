"""Strokes on a grid of tiles."""

import numpy as np
import pytest

from tilenca.shapes import raster
from tilenca.shapes.cells import cells_of, connected

DIAGONAL = np.array(((0.0, 0.0), (1.0, 1.0)))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("pen", [(1, 1), (2, 1), (2, 3)])
def test_any_stroke_is_connected_by_sides_and_fills_its_box(seed: int, pen: tuple[int, int]) -> None:
    random = np.random.default_rng(seed)
    stroke = np.concatenate((DIAGONAL, random.random((4, 2))))
    size = int(random.integers(4, 15)), int(random.integers(4, 15))
    rows = raster.rows_of_grid(raster.draw([stroke], [], size, pen, bool(seed % 2)))
    assert connected(cells_of(rows))
    assert (len(rows), len(rows[0])) == size


def test_diagonals_go_sideways_first_or_down_first() -> None:
    flat, steep = (
        raster.rows_of_grid(raster.draw([DIAGONAL], [], (2, 2), (1, 1), first)) for first in (True, False)
    )
    assert (flat, steep) == (("##", ".#"), ("#.", "##"))


def test_a_filled_polygon_is_filled_to_its_border() -> None:
    square = np.array(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)))
    assert raster.draw([], [square], (4, 5), (1, 1), True).all()


@pytest.mark.parametrize(
    ("rows", "holes", "crossings"),
    [
        (("####", "#..#", "####", "#..#", "####"), 2, 3),
        (("###", "#.#", "###"), 1, 2),
        ((".#.", "#.#", ".#."), 1, 2),
        (("#",), 0, 1),
        (("#####", "....#", "#####"), 0, 2),
    ],
)
def test_holes_and_crossings_are_counted(rows: tuple[str, ...], holes: int, crossings: int) -> None:
    grid = np.array([[mark == "#" for mark in row] for row in rows])
    if connected(cells_of(rows)):
        assert raster.holes(grid) == holes
    assert raster.crossings(grid) == crossings


def test_an_empty_grid_has_no_rows() -> None:
    assert raster.rows_of_grid(np.zeros((3, 3), np.bool_)) == ()
