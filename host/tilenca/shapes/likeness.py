"""How alike drawings are: the distance between them, brought to one size. numpy only."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.stretch import Rows
from tilenca.shapes.variant import TRAINED, Variant, Variants

SIZE = 12, 10  # rows and columns at which drawings are compared
ASPECT = 1.5  # weight of the logarithm of width by height
CLOSE, FAR = 0.15, 0.9
MOST_WHOLE = 2000
MOST_ASKED, FEWEST_ASKED = 500, 10  # drawings of an index that are compared with the others
FEW_CLOSE, FEW_FAR = 1.0, 2.0  # where an index has too few


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
        random: chooses those that are compared with the others, for `close` and `far`.

    Attributes:
        close: the `CLOSE` quantile of the distances between a drawing of the index and the nearest other one.
        far: the `FAR` quantile.
    """

    def __init__(self, drawings: Iterable[Rows], random: np.random.Generator) -> None:
        self._known = np.stack([features(rows) for rows in drawings])
        self._squares = np.square(self._known).sum(axis=1)
        self.close, self.far = self._quantiles(random)

    def _quantiles(self, random: np.random.Generator) -> tuple[float, float]:
        order = random.permutation(len(self._known))
        asked, others = np.split(order, [min(MOST_ASKED, len(order) // 5)])
        if len(asked) < FEWEST_ASKED:
            return FEW_CLOSE, FEW_FAR
        nearest = [self._distances(self._known[number])[others].min() for number in asked]
        close, far = np.quantile(nearest, (CLOSE, FAR))
        return float(close), float(far)

    def could_be_one(self, rows: Rows, of_strokes: bool) -> bool:
        """Whether a drawing could be taken for one of the index.

        Args:
            rows: the drawing.
            of_strokes: whether it consists of strokes as those of the index do, and so may be farther away.
        """
        return self.nearest(rows)[1] <= (self.far if of_strokes else self.close)

    def distances(self, rows: Rows) -> NDArray[np.float32]:
        """(K,) float32, the distance from each drawing of the index."""
        return self._distances(features(rows))

    def _distances(self, asked: NDArray[np.float32]) -> NDArray[np.float32]:
        squares = self._squares - 2 * (self._known @ asked) + asked @ asked
        distances: NDArray[np.float32] = np.sqrt(np.maximum(squares, 0))
        return distances

    def nearest(self, rows: Rows) -> tuple[int, float]:
        """The number of the most similar drawing, and its distance."""
        distances = self.distances(rows)
        number = int(distances.argmin())
        return number, float(distances[number])


def index_of(
    whole: Sequence[Rows], variants: Variants | None, count: int, random: np.random.Generator
) -> tuple[Likeness, list[Variant]]:
    """An index of a task's drawings and of variants that may be trained, and these variants.

    Args:
        whole: the task's drawings; of many, `MOST_WHOLE` by chance are in the index.
        variants: draws the others; None: there are none.
        count: about how many variants.
        random: the only source of chance.
    """
    labels = () if variants is None else variants.labels
    tries = (
        (variants.draw(labels[number % len(labels)], TRAINED, random) for number in range(2 * count))
        if variants
        else ()
    )
    drawn = [variant for variant in tries if variant is not None]
    some = sorted(random.permutation(len(whole))[:MOST_WHOLE].tolist())
    return Likeness(
        [*(whole[number] for number in some), *(variant.rows for variant in drawn)], random
    ), drawn
