"""Strokes become tiles: polylines and filled polygons on a grid, connected by their sides. numpy only."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.skeleton import Points
from tilenca.shapes.stretch import Rows

Grid = NDArray[np.bool_]
STEP = 0.2  # of a tile, between two points of a stroke


def draw(
    strokes: Iterable[Points],
    fills: Iterable[Points],
    size: tuple[int, int],
    pen: tuple[int, int],
    flat: bool,
) -> Grid:
    """Draws on a grid.

    Args:
        strokes: (n, 2) polylines with coordinates 0..1, x to the right and y down.
        fills: (n, 2) convex polygons, likewise.
        size: rows and columns of the grid.
        pen: rows and columns of the pen; strokes are so thick.
        flat: whether a diagonal step goes sideways first, or up and down first.

    Returns:
        (rows, columns) bool. Each stroke is connected by its sides.
    """
    rows, cols = size
    grid = np.zeros(size, np.bool_)
    room = np.array((max(cols - pen[1], 0), max(rows - pen[0], 0)), np.float64)
    for stroke in strokes:
        for row, col in _cells(stroke * room, flat):
            grid[row : row + pen[0], col : col + pen[1]] = True
    for fill in fills:
        grid |= _inside(fill * room + (np.array(pen[::-1]) - 1) / 2, size)
    return grid


def _cells(stroke: Points, flat: bool) -> list[tuple[int, int]]:
    """(row, column) of the cells along a polyline, each beside the one before."""
    along = np.diff(stroke, axis=0)
    counts = np.maximum(np.rint(np.abs(along).max(axis=1) / STEP).astype(np.int64), 1)
    part = np.repeat(np.arange(len(along)), counts)
    share = (np.arange(len(part)) - (np.cumsum(counts) - counts)[part]) / counts[part]
    points = np.concatenate((stroke[part] + share[:, None] * along[part], stroke[-1:]))
    rounded = np.floor(points + 0.5).astype(np.int64)
    cells: list[tuple[int, int]] = []
    for col, row in rounded[np.append(True, (np.diff(rounded, axis=0) != 0).any(axis=1))].tolist():
        if cells and cells[-1][0] != row and cells[-1][1] != col:
            cells.append((cells[-1][0], col) if flat else (row, cells[-1][1]))
        cells.append((row, col))
    return cells


def _inside(polygon: Points, size: tuple[int, int]) -> Grid:
    """The cells whose centres lie in a convex polygon, or on its border."""
    y, x = np.mgrid[: size[0], : size[1]]
    sides = [
        (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
        for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
    ]
    inside: Grid = np.all([side >= -1e-9 for side in sides], axis=0) | np.all(
        [side <= 1e-9 for side in sides], axis=0
    )
    return inside


def holes(grid: Grid) -> int:
    """How many holes a connected drawing has, from its Euler number (Gray, 1971).

    Tiles are connected by their sides, so what is empty is connected by sides and corners.
    """
    padded = np.pad(grid, 1).astype(np.int64)
    quads = padded[:-1, :-1] + 2 * padded[:-1, 1:] + 4 * padded[1:, :-1] + 8 * padded[1:, 1:]
    counts = np.bincount(quads.ravel(), minlength=16)
    ones, threes = counts[[1, 2, 4, 8]].sum(), counts[[7, 11, 13, 14]].sum()
    diagonals = counts[[6, 9]].sum()
    return 1 - int(ones - threes + 2 * diagonals) // 4


def crossings(grid: Grid) -> int:
    """The most strokes that lie above each other: runs of tiles in a column."""
    begins = grid & ~np.pad(grid, ((1, 0), (0, 0)))[:-1]
    return int(begins.sum(axis=0).max())


def rows_of_grid(grid: Grid) -> Rows:
    """The drawing as text rows, trimmed; empty where there is no tile."""
    some_rows, some_cols = np.flatnonzero(grid.any(axis=1)), np.flatnonzero(grid.any(axis=0))
    if not len(some_rows):
        return ()
    part = grid[some_rows[0] : some_rows[-1] + 1, some_cols[0] : some_cols[-1] + 1]
    marks: Sequence[bytes] = [bytes(row) for row in np.where(part, ord("#"), ord(".")).astype(np.uint8)]
    return tuple(row.decode() for row in marks)
