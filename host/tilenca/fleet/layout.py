"""The places of tiles, computed from their neighbours. Pure: the neighbour on each side in, cells out."""

from collections.abc import Mapping
from dataclasses import dataclass

from tilenca.base.sides import OFFSETS, SIDES, opposite

# Per tile, per side letter: the neighbour's id and the letter of its side that faces us.
Neighbours = Mapping[int, Mapping[str, tuple[int, str]]]


@dataclass(frozen=True)
class Arrangement:
    """The places of tiles.

    Attributes:
        cells: (row, column) per tile id; rows from the north, columns from the west, from 0.
        groups: tile ids of each connected group, the largest first; the groups' relative places are unknown.
        conflicts: contradictions between tiles, for people.
    """

    cells: dict[int, tuple[int, int]]
    groups: list[list[int]]
    conflicts: list[str]


def arrange(neighbours: Neighbours) -> Arrangement:
    """Lays out tiles, including those that only their neighbours report.

    Each group lies beside the one before, with an empty column between them.
    """
    conflicts: list[str] = []
    groups: list[dict[int, tuple[int, int]]] = []
    waiting = sorted(neighbours)
    while waiting:
        group = _grow(waiting[0], neighbours, conflicts)
        waiting = [tile for tile in waiting if tile not in group]
        groups.append(group)
    groups.sort(key=lambda group: (-len(group), min(group)))
    cells: dict[int, tuple[int, int]] = {}
    left = 0
    for group in groups:
        top, west = min(row for row, _ in group.values()), min(col for _, col in group.values())
        cells.update({tile: (row - top, col - west + left) for tile, (row, col) in group.items()})
        left += max(col for _, col in group.values()) - west + 2
    return Arrangement(cells, [sorted(group) for group in groups], conflicts)


def _grow(first: int, neighbours: Neighbours, conflicts: list[str]) -> dict[int, tuple[int, int]]:
    """All tiles that can be reached from one, around (0, 0)."""
    group = {first: (0, 0)}
    taken = {(0, 0): first}
    edge = [first]
    while edge:
        tile = edge.pop(0)
        row, col = group[tile]
        for side, other in _joined(tile, neighbours, conflicts):
            down, right = OFFSETS[SIDES.index(side)]
            cell = row + down, col + right
            if group.get(other, cell) != cell:
                conflicts.append(f"tile {other} is on side {side} of tile {tile}, and elsewhere too")
            elif taken.get(cell, other) != other:
                conflicts.append(f"tiles {taken[cell]} and {other} lie at the same place, beside tile {tile}")
            elif other not in group:
                group[other], taken[cell] = cell, other
                edge.append(other)
    return group


def _joined(tile: int, neighbours: Neighbours, conflicts: list[str]) -> list[tuple[str, int]]:
    """A tile's neighbours: those it hears, and those that hear it."""
    joined = []
    for side, (other, facing) in neighbours.get(tile, {}).items():
        if facing == _facing(side):
            joined.append((side, other))
        else:
            conflicts.append(f"side {side} of tile {tile} is joined to side {facing} of tile {other}")
    for other, about in neighbours.items():
        for side, (heard, facing) in about.items():
            if heard == tile and facing == _facing(side) and (facing, other) not in joined:
                joined.append((facing, other))
    return joined


def _facing(side: str) -> str:
    return SIDES[opposite(SIDES.index(side))]
