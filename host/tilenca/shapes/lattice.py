"""Random strokes on a lattice: they could be a sign, but not one of the task's. numpy only."""

import numpy as np

from tilenca.shapes.skeleton import Skeleton

DIAGONALS = 0.25  # the share of skeletons with diagonal strokes
FEWEST, MOST = 3, 10  # strokes


def random_skeleton(random: np.random.Generator) -> Skeleton:
    """A connected choice of strokes between the points of a small lattice, in a unit square."""
    cols, rows = int(random.integers(2, 4)), int(random.integers(2, 5))
    steps = [(1, 0), (0, 1)] + ([(1, 1), (1, -1)] if random.random() < DIAGONALS else [])
    possible = [
        ((x, y), (x + dx, y + dy))
        for x in range(cols)
        for y in range(rows)
        for dx, dy in steps
        if x + dx < cols and 0 <= y + dy < rows
    ]
    reached = {(int(random.integers(cols)), int(random.integers(rows)))}
    chosen: list[tuple[tuple[int, int], tuple[int, int]]] = []
    for _ in range(int(random.integers(FEWEST, MOST + 1))):
        near = [
            edge for edge in possible if edge not in chosen and (edge[0] in reached or edge[1] in reached)
        ]
        if not near:
            break
        edge = near[int(random.integers(len(near)))]
        chosen.append(edge)
        reached |= set(edge)
    number = {point: place for place, point in enumerate(sorted(reached))}
    points = np.array(sorted(reached), np.float64) / (max(cols - 1, 1), max(rows - 1, 1))
    return Skeleton(points, tuple((number[a], number[b]) for a, b in chosen))
