"""How alike drawings are: the distance between them, brought to one size. numpy only."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.stretch import Rows

SIZE = 12, 10  # rows and columns at which drawings are compared
ASPECT = 1.5  # weight of the logarithm of width by height


def features(rows: Rows) -> NDArray[np.float32]:
    """(121,) float32: the drawing stretched to one size and blurred a little, and its proportions."""
    marks = np.array([[mark == "#" for mark in row] for row in rows], np.float32)
    heights, widths = (
        np.minimum(np.arange(n) * side // n, side - 1) for n, side in zip(SIZE, marks.shape, strict=True)
    )
    grid = np.pad(marks[np.ix_(heights, widths)], 1)
    blurred = 2 * grid[1:-1, 1:-1] + grid[:-2, 1:-1] + grid[2:, 1:-1] + grid[1:-1, :-2] + grid[1:-1, 2:]
    proportion = ASPECT * np.log(len(rows[0]) / len(rows))
    return np.append(blurred / 6, proportion).astype(np.float32)


class Likeness:
    """An index of drawings, to find out whether another one could be taken for one of them.

    Args:
        drawings: K of them.
    """

    def __init__(self, drawings: Iterable[Rows]) -> None:
        self._known = np.stack([features(rows) for rows in drawings])
        self._squares = np.square(self._known).sum(axis=1)

    def distances(self, rows: Rows) -> NDArray[np.float32]:
        """(K,) float32, the distance from each drawing of the index."""
        asked = features(rows)
        squares = self._squares - 2 * (self._known @ asked) + asked @ asked
        distances: NDArray[np.float32] = np.sqrt(np.maximum(squares, 0))
        return distances

    def nearest(self, rows: Rows) -> tuple[int, float]:
        """The number of the most similar drawing, and its distance."""
        distances = self.distances(rows)
        number = int(distances.argmin())
        return number, float(distances[number])
