"""The same drawing at another size: lines get longer, not thicker.

A drawing consists of tiles joined to their neighbours. Stretching keeps the tiles of every row; a row in
between has a tile wherever the rows above and below both have one; columns likewise. Strokes one tile wide
stay one tile wide, filled areas stay filled. Shrinking removes rows and columns that stretching would
restore.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise

Rows = tuple[str, ...]

MOST_CHANGED = (
    4  # rows that a missing tile makes necessary or superfluous: its own, both beside it, an empty one
)
_BITS = str.maketrans("#.", "10")


def stretch(rows: Rows, height: int, width: int, up: bool = True) -> Rows | None:
    """A drawing at another size.

    Args:
        rows: the drawing, rectangular, `#` and `.`.
        height: rows wanted.
        width: columns wanted.
        up: where a row or column would come to lie half-way between two places, take the later one.

    Returns:
        The drawing with `height` rows and `width` columns; None where it cannot be drawn that small.
    """
    if width > 1 and all(len(row) == 1 for row in rows):
        return stretch_rows(rows, height, up)  # a vertical line has no width to stretch
    if height > 1 and len(rows) == 1:
        turned = stretch_rows(_turned(rows), width, up)
        return None if turned is None else _turned(turned)
    taller = stretch_rows(rows, height, up)
    wider = None if taller is None else stretch_rows(_turned(taller), width, up)
    return None if wider is None else _turned(wider)


def stretch_rows(rows: Rows, height: int, up: bool = True) -> Rows | None:
    """A drawing with `height` rows; None where it cannot be drawn that low."""
    while len(rows) > height:
        shorter = next(_without_a_row(rows), None)
        if shorter is None:
            return None
        rows = shorter
    if len(rows) in (1, height):  # a single row has no joint to stretch
        return rows
    places = [_place(index, len(rows), height, up) for index in range(len(rows))]
    return place_rows(rows, places)


def place_rows(rows: Rows, places: Sequence[int]) -> Rows:
    """Puts row i at `places[i]`, ascending from 0, and joins them."""
    placed = list(rows[:1])
    for above, below, gap in zip(rows, rows[1:], _gaps(places), strict=False):
        placed += [_joint(above, below)] * (gap - 1)
        placed.append(below)
    return tuple(placed)


def smallest(rows: Rows) -> Rows:
    """The smallest drawing that stretches to this one: equal for all sizes of one drawing."""
    return _turned(_lowest(_turned(_lowest(rows))))


class Extent:
    """Rows and columns of `smallest` of a drawing, and of it less one tile, without drawing any.

    Which rows go does not depend on which columns went before, so that rows and columns are counted apart.

    Attributes:
        whole: rows and columns with all tiles.
    """

    def __init__(self, rows: Rows) -> None:
        self._rows = [int(row.translate(_BITS)[::-1], 2) for row in rows]
        self._columns = [int(column.translate(_BITS)[::-1], 2) for column in _turned(rows)]
        self.whole = _height(self._rows.copy()), _height(self._columns.copy())

    def is_near(self, other: tuple[int, int]) -> bool:
        """Whether this extent less one tile can be the other: that changes few rows and columns."""
        return all(abs(mine - theirs) <= MOST_CHANGED for mine, theirs in zip(self.whole, other, strict=True))

    def without(self, row: int, column: int) -> tuple[int, int]:
        """The extent where the tile in this place is missing."""
        rows, columns = self._rows.copy(), self._columns.copy()
        rows[row] &= ~(1 << column)
        columns[column] &= ~(1 << row)
        return _height(rows), _height(columns)


def _height(bits: list[int]) -> int:
    """How many rows are left of these, without empty ones at the border."""
    while bits and not bits[-1]:
        bits.pop()
    while bits and not bits[0]:
        del bits[0]
    return len(_kept(bits))


def _lowest(rows: Rows) -> Rows:
    """Without the rows that their neighbours imply; the order in which they go makes no difference."""
    return tuple(rows[index] for index in _kept([int(row.translate(_BITS), 2) for row in rows]))


def _kept(bits: Sequence[int]) -> list[int]:
    """The indices of the rows, a bit for each tile, that their neighbours do not imply."""
    kept: list[int] = []
    for index in range(len(bits)):
        kept.append(index)
        while len(kept) > 2 and bits[kept[-2]] == bits[kept[-3]] & bits[kept[-1]]:
            del kept[-2]
    return kept


def _without_a_row(rows: Rows) -> Iterator[Rows]:
    """The drawing without one row that its neighbours imply, the row nearest to the middle first."""
    for index in sorted(range(1, len(rows) - 1), key=lambda index: (abs(2 * index + 1 - len(rows)), index)):
        if rows[index] == _joint(rows[index - 1], rows[index + 1]):
            yield (*rows[:index], *rows[index + 1 :])


def _joint(above: str, below: str) -> str:
    return "".join("#" if a == b == "#" else "." for a, b in zip(above, below, strict=True))


def _gaps(places: Sequence[int]) -> list[int]:
    return [later - earlier for earlier, later in pairwise(places)]


def _place(index: int, count: int, wanted: int, up: bool) -> int:
    """`index * (wanted - 1) / (count - 1)` rounded, halves up or down."""
    doubled = 2 * index * (wanted - 1)
    step = 2 * (count - 1)
    return (doubled + count - 1) // step if up else -((count - 1 - doubled) // step)


def _turned(rows: Rows) -> Rows:
    return tuple("".join(column) for column in zip(*rows, strict=True))
