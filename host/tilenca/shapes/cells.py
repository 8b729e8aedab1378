"""The tiles of a drawing as cells, and whether they are connected."""

from collections.abc import Iterable, Sequence

from tilenca.base.sides import OFFSETS

TILE = "#"


def cells_of(rows: Iterable[str]) -> tuple[tuple[int, int], ...]:
    """(row, column) of every tile of a drawing in reading order."""
    return tuple((r, c) for r, row in enumerate(rows) for c, mark in enumerate(row) if mark == TILE)


def connected(cells: Iterable[tuple[int, int]]) -> bool:
    """Whether all cells are connected by their sides."""
    left = set(cells)
    front = [left.pop()] if left else []
    while front:
        row, col = front.pop()
        for dr, dc in OFFSETS:
            if (cell := (row + dr, col + dc)) in left:
                left.remove(cell)
                front.append(cell)
    return not left


def apart(cells: Sequence[tuple[int, int]]) -> tuple[int, int]:
    """The first cell of the smallest part of cells that are not connected."""
    left, parts = set(cells), []
    while left:
        part = [left.pop()]
        for row, col in part:
            near = [cell for dr, dc in OFFSETS if (cell := (row + dr, col + dc)) in left]
            left.difference_update(near)
            part += near
        parts.append(sorted(part))
    return min(parts, key=lambda part: (len(part), part[0]))[0]


def beside(cells: Iterable[tuple[int, int]]) -> set[tuple[int, int]]:
    """The empty places that have a cell beside them."""
    tiles = set(cells)
    return {(row + dr, col + dc) for row, col in tiles for dr, dc in OFFSETS} - tiles


def removable(cells: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Those of connected cells that leave the others connected, in their order.

    These are all but the articulation points (Hopcroft & Tarjan, 1973), found in one walk.
    """
    tiles = set(cells)
    way = [cells[0]]
    found = {cells[0]: 0}  # when the walk came to a cell
    earliest = {cells[0]: 0}  # the first cell that it, or what was found from it, has beside it
    joints: set[tuple[int, int]] = set()
    branches = 0  # that begin at the first cell
    while way:
        row, col = cell = way[-1]
        around = [near for dr, dc in OFFSETS if (near := (row + dr, col + dc)) in tiles]
        if new := next((near for near in around if near not in found), None):
            found[new] = earliest[new] = len(found)
            way.append(new)
            continue
        way.pop()
        if way:
            before = way[-1]
            first = min([earliest[cell], *(found[near] for near in around if near != before)])
            earliest[before] = min(earliest[before], first)
            branches += before == cells[0]
            if first >= found[before] and before != cells[0]:
                joints.add(before)
    if branches > 1:
        joints.add(cells[0])
    return [cell for cell in cells if cell not in joints]
