"""Forms: one way to draw a class, made from a skeleton by chance, and drawn at any size and thickness.

A form is what a hand decides before it chooses a size: where bars lie, how corners are rounded, how far a
digit leans, where a stroke ends in a hook. All sizes and thicknesses of one form are one form, so a split by
form keeps them together (`key`). numpy only.
"""

import math
import zlib
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes import raster
from tilenca.shapes.sizes import Size
from tilenca.shapes.skeleton import Points, Skeleton
from tilenca.shapes.stretch import Rows, smallest
from tilenca.shapes.vary import Vary

KEY_SIZE = 11, 9  # the size at which forms are compared
HOOK, FOOT = (0.1, 0.28), (0.08, 0.22)  # least and most length, as a share of the size
LINE = 4  # a form this much longer than wide is a line, and stays this much longer than it is thick
SHORTEST = 0.4  # of a stroke's length must remain when its end is cut
ROUNDS = 3  # of corner cutting make a corner round


@dataclass(frozen=True, eq=False)
class Form:
    """Strokes and filled areas in a unit square.

    Attributes:
        strokes: (n, 2) polylines.
        fills: (n, 2) polygons.
        holes: of a drawing of it.
        aspect: width by height; both are 1 in the square.
        flat: whether diagonal steps go sideways first.
    """

    strokes: tuple[Points, ...]
    fills: tuple[Points, ...]
    holes: int
    aspect: float
    flat: bool

    def draw(self, size: Size, pen: tuple[int, int] = (1, 1)) -> Rows | None:
        """The drawing at a size; None where holes or gaps would close, or a line become a block.

        Args:
            size: rows and columns of the bounding box; a line without width fills a column.
            pen: rows and columns of the pen.
        """
        rows, cols = size
        if rows < pen[0] or cols < pen[1]:
            return None
        if (self.aspect < 1 / LINE and rows < LINE * pen[1]) or (self.aspect > LINE and cols < LINE * pen[0]):
            return None
        grid = raster.draw(self.strokes, self.fills, size, pen, self.flat)
        if raster.holes(grid) != self.holes or raster.crossings(grid) < self.crossings:
            return None
        if grid.all() and 1 / LINE <= self.aspect <= LINE and not self.fills:
            return None
        return raster.rows_of_grid(grid)

    @cached_property
    def crossings(self) -> int:
        """How many strokes lie above each other where most do."""
        return raster.crossings(raster.draw(self.strokes, self.fills, KEY_SIZE, (1, 1), True))

    def key(self) -> int:
        """A number that all drawings of equal forms share, from the form drawn thin at one size."""
        grid = raster.draw(self.strokes, self.fills, KEY_SIZE, (1, 1), True)
        return zlib.crc32("/".join(smallest(raster.rows_of_grid(grid))).encode())


def make_form(skeleton: Skeleton, vary: Vary, random: np.random.Generator) -> Form:
    """Draws a form of a class by chance.

    Args:
        skeleton: of the class.
        vary: how far it may differ.
        random: the only source of chance.
    """
    points = _moved_bars(skeleton.points, vary.bars, random)
    width = max(float(np.ptp(points[:, 0])), 1e-9)
    height = max(float(np.ptp(points[:, 1])), 1e-9)
    scale = max(width, height)
    points = points + random.normal(0, vary.jitter * scale, points.shape) * _reach(points)
    skeleton = replace(skeleton, points=points)
    skeleton = _ends(skeleton, vary, random, scale)
    strokes = _rounded(skeleton, vary, random)
    fills = [skeleton.points[list(fill)] for fill in skeleton.fills]
    strokes, fills = _leaning(strokes, fills, vary, random)
    return _in_unit_square(strokes, fills, skeleton.holes, bool(random.random() < 0.5))


def _reach(points: Points) -> NDArray[np.float64]:
    """(2,) 1 for a direction in which points differ, less for one in which they do not: lines stay lines."""
    extent = np.ptp(points, axis=0)
    reach: NDArray[np.float64] = np.where(extent > 0, 1.0, 0.3)
    return reach


def _moved_bars(points: Points, spread: float, random: np.random.Generator) -> Points:
    """Distances between the levels at which points lie become longer or shorter, axis by axis."""
    moved = points.copy()
    for axis in (0, 1):
        levels, place = np.unique(points[:, axis].round(6), return_inverse=True)
        gaps = np.diff(levels) * np.exp(random.normal(0, spread, len(levels) - 1))
        extent = levels[-1] - levels[0]
        at = np.concatenate(([0.0], np.cumsum(gaps)))
        if extent > 0:
            at *= extent / at[-1]
        moved[:, axis] = at[place]
    return moved


def _ends(skeleton: Skeleton, vary: Vary, random: np.random.Generator, scale: float) -> Skeleton:
    """Free ends become longer or shorter, and some get a hook or a foot."""
    points, edges = [*skeleton.points], [*skeleton.edges]
    top, bottom = skeleton.points[:, 1].min(), skeleton.points[:, 1].max()
    middle = (skeleton.points.min(axis=0) + skeleton.points.max(axis=0)) / 2
    for end, before in skeleton.ends:
        along = points[end] - points[before]
        length = float(np.hypot(*along))
        if length == 0:
            continue
        along = along / length
        change = max(random.uniform(-vary.ends, vary.ends) * scale, (SHORTEST - 1) * length)
        points[end] = points[end] + change * along
        across = np.array((-along[1], along[0]))
        chance = random.random()
        if (
            chance < vary.feet
            and abs(along[1]) > 0.8
            and min(abs(points[end][1] - top), abs(points[end][1] - bottom)) < 0.2 * scale
        ):
            for side in (-1, 1):
                points.append(points[end] + side * random.uniform(*FOOT) * scale * across)
                edges.append((end, len(points) - 1))
        elif chance < vary.feet + vary.hooks:
            inward = 1 if across @ (middle - points[end]) >= 0 else -1
            side = inward if random.random() < 0.7 else -inward
            bent = side * across + random.uniform(-0.3, 0.6) * along
            points.append(points[end] + random.uniform(*HOOK) * scale * bent / np.hypot(*bent))
            edges.append((end, len(points) - 1))
    return Skeleton(np.array(points), tuple(edges), skeleton.fills)


def _rounded(skeleton: Skeleton, vary: Vary, random: np.random.Generator) -> list[Points]:
    """The strokes as polylines, with corners cut or rounded (Chaikin, 1974)."""
    rounded = random.random() < vary.corners
    rounds = int(random.integers(1, ROUNDS + 1))
    share = random.uniform(0.15, 0.4 if rounds == 1 else 0.28)
    strokes = []
    for path in skeleton.paths:
        stroke = skeleton.points[path]
        if rounded and not skeleton.fills:
            closed = path[0] == path[-1] and skeleton.degree[path[0]] == 2
            for _ in range(rounds):
                stroke = _cut(stroke, share, closed)
        strokes.append(stroke)
    return strokes


def _cut(stroke: Points, share: float, closed: bool) -> Points:
    """A polyline with every corner cut off at a share of its two sides."""
    if len(stroke) < 3:
        return stroke
    a, b = stroke[:-1], stroke[1:]
    near, far = a + share * (b - a), b + share * (a - b)
    cut = np.stack((near, far), axis=1).reshape(-1, 2)
    if closed:
        return np.concatenate((cut, cut[:1]))
    return np.concatenate((stroke[:1], cut[1:-1], stroke[-1:]))


def _leaning(
    strokes: list[Points], fills: list[Points], vary: Vary, random: np.random.Generator
) -> tuple[list[Points], list[Points]]:
    """All of it turned and slanted."""
    turn = math.radians(random.uniform(-vary.turn, vary.turn)) if random.random() < 0.5 else 0.0
    slant = random.uniform(-vary.slant, vary.slant) if random.random() < 0.6 else 0.0
    matrix = np.array(((math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))))
    matrix = matrix @ np.array(((1.0, 0.0), (-slant, 1.0)))
    return [stroke @ matrix for stroke in strokes], [fill @ matrix for fill in fills]


def _in_unit_square(strokes: list[Points], fills: list[Points], holes: int, flat: bool) -> Form:
    every = np.concatenate((*strokes, *fills))
    corner, extent = every.min(axis=0), np.ptp(every, axis=0)
    scale = np.maximum(extent, 1e-9)

    def within(part: Points) -> Points:
        moved: Points = np.where(extent > 1e-6, (part - corner) / scale, 0.0)
        return moved

    return Form(
        tuple(map(within, strokes)),
        tuple(map(within, fills)),
        holes,
        float(extent[0] / max(extent[1], 1e-9)),
        flat,
    )
