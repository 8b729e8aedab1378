"""Drawings made from drawings: damaged ones that keep their class, and ones that belong to no class.

Everything here works on rows of `#` and `.`, trimmed to the tiles. numpy only.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from tilenca.base.sides import OFFSETS
from tilenca.shapes.cells import cells_of, connected, removable
from tilenca.shapes.stretch import Extent, Rows, smallest

Cell = tuple[int, int]
GIVE_UP = 300  # draws in a row without a new drawing


def rows_of(cells: Iterable[Cell]) -> Rows:
    """The drawing of these tiles, trimmed."""
    rows, cols = zip(*(tiles := list(cells)), strict=True)
    top, left = min(rows), min(cols)
    drawing = [bytearray(b"." * (max(cols) - left + 1)) for _ in range(max(rows) - top + 1)]
    for row, col in tiles:
        drawing[row - top][col - left] = ord("#")
    return tuple(row.decode() for row in drawing)


def without_one(rows: Rows) -> Iterator[Rows]:
    """The drawing without one of its tiles, for every tile that leaves the others connected."""
    cells = cells_of(rows)
    for row, col in removable(cells) if len(cells) > 1 else ():
        yield _without(rows, row, col)


def _without(rows: Rows, row: int, col: int) -> Rows:
    """The drawing without the tile in this place, which is not its only one."""
    rest = (*rows[:row], rows[row][:col] + "." + rows[row][col + 1 :], *rows[row + 1 :])
    # Only at the border a row or a column can become empty.
    inside = 0 < row < len(rows) - 1 and 0 < col < len(rows[0]) - 1
    return rest if inside else rows_of(cells_of(rest))


class Known:
    """An index of a task's drawings: the class of any drawing, whole or damaged.

    Args:
        drawings: (label, rows) of every drawing of the task, all sizes.
    """

    def __init__(self, drawings: Iterable[tuple[str, Rows]]) -> None:
        self._drawings = list(drawings)
        self.forms: dict[Rows, str] = {}
        self._claims: dict[Rows, set[str]] = {}
        self._damaged: dict[tuple[str, Rows], list[Rows]] = {}
        for label, rows in self._drawings:
            self.forms.setdefault(smallest(rows), label)
            for less in without_one(rows):
                self._claims.setdefault(less, set()).add(label)
        self._extents = {(len(form), len(form[0])) for form in self.forms}

    def damaged(self, label: str, rows: Rows) -> Sequence[Rows]:
        """`rows` with one tile missing, where that is neither another whole drawing nor another's damage."""
        if (label, rows) not in self._damaged:
            whole = {less for less, _ in self._whole_without_one(rows)}
            self._damaged[label, rows] = [
                less
                for less in dict.fromkeys(without_one(rows))
                if self._claims.get(less, set()) == {label} and less not in whole
            ]
        return self._damaged[label, rows]

    def lookalikes(self) -> dict[str, list[str]]:
        """For every label the others that it looks like when the wrong tile is missing."""
        found: dict[str, set[str]] = {}
        for label, rows in self._drawings:
            for _, other in self._whole_without_one(rows):
                if other != label:
                    found.setdefault(label, set()).add(other)
        return {label: sorted(others) for label, others in found.items()}

    def is_known(self, rows: Rows) -> bool:
        """Whether a drawing is one of the task's, at any size, or one with a tile missing or too many."""
        return (
            rows in self._claims
            or smallest(rows) in self.forms
            or any(True for _ in self._whole_without_one(rows))
        )

    def _whole_without_one(self, rows: Rows) -> Iterator[tuple[Rows, str]]:
        """The whole drawings, at any size, that `rows` is with one tile missing, and their classes.

        Of hundreds of tiles hardly one leaves the extent of a whole drawing; nothing is drawn for the others.
        """
        extent = Extent(rows)
        if not any(extent.is_near(other) for other in self._extents):
            return
        for row, col in removable(cells_of(rows)):
            if extent.without(row, col) in self._extents:
                less = _without(rows, row, col)
                if (label := self.forms.get(smallest(less))) is not None:
                    yield less, label


def grown(random: np.random.Generator, tiles: int, height: int, width: int) -> Rows:
    """A random connected drawing of at most `tiles` tiles within `height` x `width`."""
    return _grow(random, tiles, [(row, col) for row in range(height) for col in range(width)])


def half(random: np.random.Generator, rows: Rows) -> Rows:
    """A random connected half of a drawing."""
    cells = cells_of(rows)
    return _grow(random, max(1, len(cells) // 2), cells)


def edited(random: np.random.Generator, rows: Rows, edits: int) -> Rows | None:
    """The drawing with some tiles added or removed; None if that tears it apart."""
    height, width = len(rows), len(rows[0])
    tiles = set(cells_of(rows))
    for _ in range(edits):
        tiles ^= {(int(random.integers(-1, height + 1)), int(random.integers(-1, width + 1)))}
    return rows_of(tiles) if tiles and connected(tiles) else None


def segments(drawings: Sequence[Rows]) -> list[frozenset[Cell]]:
    """The straight strokes between corners and junctions of all drawings laid on each other.

    Of the ten digits these are the seven segments of a 7-segment digit.
    """
    tiles = {cell for rows in drawings for cell in cells_of(rows)}
    nodes = {cell for cell in tiles if not _straight(tiles, cell)}
    found = set()
    for node in nodes:
        for down, right in OFFSETS:
            stroke, cell = [node], (node[0] + down, node[1] + right)
            while cell in tiles and cell not in nodes:
                stroke.append(cell)
                cell = (cell[0] + down, cell[1] + right)
            if cell in tiles:
                found.add(frozenset((*stroke, cell)))
    return sorted(found, key=sorted)


def some_segments(random: np.random.Generator, strokes: Sequence[frozenset[Cell]]) -> Rows | None:
    """A random connected choice of strokes; None where the choice is empty or torn."""
    share = random.uniform(0.2, 0.9)
    tiles = {cell for stroke in strokes if random.random() < share for cell in stroke}
    return rows_of(tiles) if tiles and connected(tiles) else None


def draw_until(wanted: int, draw: Callable[[], Rows | None], fits: Callable[[Rows], bool]) -> list[Rows]:
    """Draws until `wanted` different drawings fit, or until `GIVE_UP` draws in a row bring nothing new."""
    seen: set[Rows] = set()
    found: list[Rows] = []
    idle = 0
    while len(found) < wanted and idle < GIVE_UP:
        rows = draw()
        idle += 1
        if rows is not None and rows not in seen:
            seen.add(rows)
            idle = 0
            if fits(rows):
                found.append(rows)
    return found


# From drawings it makes a function that draws variants of them; that returns None if a try fails.
Drawer = Callable[[Sequence[Rows], np.random.Generator], Callable[[], Rows | None]]


def some_grown(
    drawings: Sequence[Rows], random: np.random.Generator, least: int = 3
) -> Callable[[], Rows | None]:
    """Random drawings of about the size of the given ones, of `least` tiles or more if those have as many."""
    height, width = max(map(len, drawings)), max(len(rows[0]) for rows in drawings)
    most = max(sum(row.count("#") for row in rows) for rows in drawings)
    return lambda: grown(random, int(random.integers(min(least, most), most + 1)), height + 1, width + 1)


def some_halves(drawings: Sequence[Rows], random: np.random.Generator) -> Callable[[], Rows | None]:
    """Halves of any of the drawings."""
    return lambda: half(random, drawings[int(random.integers(len(drawings)))])


def some_edited(drawings: Sequence[Rows], random: np.random.Generator) -> Callable[[], Rows | None]:
    """Any of the drawings with four to seven edits."""
    return lambda: edited(random, drawings[int(random.integers(len(drawings)))], int(random.integers(4, 8)))


def some_strokes(drawings: Sequence[Rows], random: np.random.Generator) -> Callable[[], Rows | None]:
    """Other choices of the drawings' strokes."""
    strokes = segments(drawings)
    return lambda: some_segments(random, strokes)


def _grow(random: np.random.Generator, tiles: int, room: Sequence[Cell]) -> Rows:
    """Tiles added one after the other, each beside an earlier one; `room` in reading order."""
    front = [room[int(random.integers(len(room)))]]
    untouched = set(room) - {front[0]}
    grown: list[Cell] = []
    while front and len(grown) < tiles:
        cell = front.pop(int(random.integers(len(front))))
        grown.append(cell)
        for down, right in OFFSETS:
            near = cell[0] + down, cell[1] + right
            if near in untouched:
                untouched.remove(near)
                front.append(near)
    return rows_of(grown)


def _straight(tiles: set[Cell], cell: Cell) -> bool:
    north, east, south, west = ((cell[0] + down, cell[1] + right) in tiles for down, right in OFFSETS)
    return (north and south and not east and not west) or (east and west and not north and not south)
