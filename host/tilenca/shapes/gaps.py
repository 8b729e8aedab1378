"""Where one tile is missing, for drawings that leave no doubt about it.

A drawing leaves no doubt if it is neither whole, at any size, nor any other whole drawing with one tile
missing, nor the same one with the tile missing elsewhere.
"""

from collections.abc import Iterable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import OFFSETS, SIDES
from tilenca.shapes.cells import cells_of, removable
from tilenca.shapes.edits import Cell, rows_of
from tilenca.shapes.file import Shape
from tilenca.shapes.stretch import Rows, smallest

Sides = NDArray[np.bool_]


class Gaps:
    """An index of whole drawings: which tile is missing in a drawing.

    Args:
        whole: all whole drawings of a task, at all sizes.
    """

    def __init__(self, whole: Iterable[Shape]) -> None:
        self._whole = {shape.rows: shape.label for shape in whole}
        self._found: dict[tuple[str, Rows], Sides | None] = {}

    @cached_property
    def _forms(self) -> set[Rows]:
        return {smallest(rows) for rows in self._whole}

    @cached_property
    def _claims(self) -> dict[Rows, set[tuple[Rows, Cell]]]:
        """By damaged drawing: the whole drawings that it may be, and the place in it that is then empty."""
        claims: dict[Rows, set[tuple[Rows, Cell]]] = {}
        for rows in self._whole:
            cells = cells_of(rows)
            for gone in removable(cells) if len(cells) > 1 else ():
                rest = [cell for cell in cells if cell != gone]
                top, left = (min(places) for places in zip(*rest, strict=True))
                claims.setdefault(rows_of(rest), set()).add((rows, (gone[0] - top, gone[1] - left)))
        return claims

    def missing(self, shape: Shape) -> tuple[Rows, Cell] | None:
        """The whole drawing, and the empty place in `shape`; it may lie outside of its rows.

        None where `shape` is whole, of another class, or leaves a doubt.
        """
        claims = self._claims.get(shape.rows, set())
        if len(claims) != 1 or shape.rows in self._whole or smallest(shape.rows) in self._forms:
            return None
        ((whole, gap),) = claims
        return (whole, gap) if self._whole[whole] == shape.label else None

    def sides(self, shape: Shape) -> Sides | None:
        """(tiles, 4) bool: the sides, N E S W, on which a tile is missing; None: it cannot be known."""
        key = shape.label, shape.rows
        if key not in self._found:
            self._found[key] = self._sides(shape)
        return self._found[key]

    def _sides(self, shape: Shape) -> Sides | None:
        if self._whole.get(shape.rows) == shape.label:
            return np.zeros((len(shape.cells), len(SIDES)), np.bool_)
        if (found := self.missing(shape)) is None:
            return None
        around = [[(row + dr, col + dc) for dr, dc in OFFSETS] for row, col in shape.cells]
        return np.array([[place == found[1] for place in places] for places in around], np.bool_)

    def damaged(self, shapes: Iterable[Shape]) -> list[Shape]:
        """Whole drawings with one tile missing, where that leaves no doubt."""
        less: dict[Rows, Shape] = {}
        for shape in shapes:
            for row, col in removable(shape.cells) if len(shape.cells) > 1 else ():
                rows = rows_of(cell for cell in shape.cells if cell != (row, col))
                other = Shape(shape.label, rows, f"{shape.name} less {row},{col}")
                if self.missing(other) is not None:
                    less.setdefault(rows, other)
        return list(less.values())
