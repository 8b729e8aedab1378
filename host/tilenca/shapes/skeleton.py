"""Skeletons: the strokes and filled areas that a drawing consists of, with coordinates that can be changed.

A skeleton is a planar graph. Its points are the ends, corners and junctions of strokes. It is made of a
drawing (`of_rows`) or of strokes given as text (`of_strokes`). numpy only.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.cells import cells_of
from tilenca.shapes.stretch import Rows

Points = NDArray[np.float64]
Edge = tuple[int, int]
Point = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Strokes and filled areas.

    Attributes:
        points: (P, 2) float64, x to the right and y down.
        edges: pairs of points that a straight stroke joins.
        fills: filled quadrilaterals, corners in order around them.
    """

    points: Points
    edges: tuple[Edge, ...]
    fills: tuple[tuple[int, int, int, int], ...] = ()

    @cached_property
    def degree(self) -> NDArray[np.int64]:
        """(P,) how many strokes meet at each point."""
        return np.bincount(np.array(self.edges, np.int64).ravel(), minlength=len(self.points))

    @cached_property
    def holes(self) -> int:
        """How many holes a connected drawing of this skeleton has (Euler's formula)."""
        return len(self.edges) - len(self.points) + 1 - len(self.fills)

    @cached_property
    def ends(self) -> list[Edge]:
        """Free ends: the point, and the point at the other end of its stroke."""
        return [
            (here, there) for a, b in self.edges for here, there in ((a, b), (b, a)) if self.degree[here] == 1
        ]

    @cached_property
    def paths(self) -> list[list[int]]:
        """Maximal chains of strokes between ends and junctions; a closed chain repeats its first point."""
        around: list[list[int]] = [[] for _ in self.points]
        for number, (a, b) in enumerate(self.edges):
            around[a].append(number)
            around[b].append(number)
        left = set(range(len(self.edges)))
        found = []

        def walk(start: int, edge: int) -> list[int]:
            path = [start]
            while True:
                left.discard(edge)
                a, b = self.edges[edge]
                path.append(b if path[-1] == a else a)
                onward = [e for e in around[path[-1]] if e in left]
                if len(around[path[-1]]) != 2 or not onward:
                    return path
                edge = onward[0]

        nodes = [point for point in range(len(self.points)) if len(around[point]) != 2]
        for start in [*nodes, *range(len(self.points))]:
            for edge in around[start]:
                if edge in left:
                    found.append(walk(start, edge))
        return found


def of_rows(rows: Rows) -> Skeleton:
    """The skeleton of a drawing: straight runs of tiles are strokes, blocks of 2 x 2 tiles are filled."""
    cells = cells_of(rows)
    index = {cell: number for number, cell in enumerate(cells)}
    edges = {
        (number, index[near])
        for (row, col), number in index.items()
        for near in ((row + 1, col), (row, col + 1))
        if near in index
    }
    fills = []
    for (row, col), number in index.items():
        corners = [index.get(cell) for cell in ((row, col + 1), (row + 1, col + 1), (row + 1, col))]
        if None not in corners:
            fills.append((number, *(corner for corner in corners if corner is not None)))
    points = np.array([(col, row) for row, col in cells], np.float64)
    return _straightened(points, edges, fills)  # type: ignore[arg-type]


def of_strokes(strokes: Sequence[Sequence[Point]]) -> Skeleton:
    """The skeleton of polylines, joined where they touch or cross.

    Raises:
        ValueError: a polyline has fewer than two points, or the strokes are not connected.
    """
    if any(len(stroke) < 2 for stroke in strokes):
        raise ValueError("a stroke needs two points or more")
    sides = [side for stroke in strokes for side in pairwise(stroke)]
    crossed = [cross for one, other in combinations(sides, 2) if (cross := _crossing(*one, *other))]
    points = list(dict.fromkeys([*(point for stroke in strokes for point in stroke), *crossed]))
    edges: set[Edge] = set()
    for a, b in sides:
        on_it = [
            (math.dist(a, point), number) for number, point in enumerate(points) if _between(a, b, point)
        ]
        edges |= {(min(x, y), max(x, y)) for (_, x), (_, y) in pairwise(sorted(on_it))}
    if not _connected(len(points), edges):
        raise ValueError("the strokes are not connected; let one end on a point of another")
    return Skeleton(np.array(points, np.float64), tuple(sorted(edges)))


def _crossing(a: Point, b: Point, c: Point, d: Point) -> Point | None:
    """Where the inner parts of two straight strokes cross; None where they do not."""
    one, other = np.subtract(b, a), np.subtract(d, c)
    turn = float(one[0] * other[1] - one[1] * other[0])
    if abs(turn) < 1e-9:
        return None
    between = np.subtract(c, a)
    along = float(between[0] * other[1] - between[1] * other[0]) / turn
    beside = float(between[0] * one[1] - between[1] * one[0]) / turn
    if not (1e-6 < along < 1 - 1e-6 and 1e-6 < beside < 1 - 1e-6):
        return None
    return float(a[0] + along * one[0]), float(a[1] + along * one[1])


def _between(a: Point, b: Point, point: Point) -> bool:
    along = np.subtract(b, a)
    at = np.subtract(point, a)
    length = float(along @ along)
    if length == 0:
        return bool((at == 0).all())
    share = float(at @ along) / length
    return -1e-9 <= share <= 1 + 1e-9 and float(np.abs(at - share * along).max()) < 1e-9


def _connected(points: int, edges: set[Edge]) -> bool:
    reached = {0}
    while more := {b for a, b in (*edges, *((b, a) for a, b in edges)) if a in reached and b not in reached}:
        reached |= more
    return len(reached) == points


def _straightened(points: Points, edges: set[Edge], fills: Sequence[tuple[int, int, int, int]]) -> Skeleton:
    """Without the points in the middle of straight strokes."""
    around: dict[int, set[int]] = {number: set() for number in range(len(points))}
    for a, b in edges:
        around[a].add(b)
        around[b].add(a)
    corners = {corner for fill in fills for corner in fill}
    gone = set()
    for number, near in around.items():
        if len(near) != 2 or number in corners:
            continue
        a, b = near
        one, other = points[a] - points[number], points[b] - points[number]
        if one[0] * other[1] == one[1] * other[0] and one @ other < 0:
            around[a] = around[a] - {number} | {b}
            around[b] = around[b] - {number} | {a}
            gone.add(number)
    left = [number for number in around if number not in gone]
    new = {number: place for place, number in enumerate(left)}
    joined = {tuple(sorted((new[a], new[b]))) for a in left for b in around[a]}
    return Skeleton(
        points[left],
        tuple(sorted((a, b) for a, b in joined)),
        tuple(tuple(new[corner] for corner in fill) for fill in fills),  # type: ignore[misc]
    )
