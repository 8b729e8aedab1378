"""Random strokes on a lattice."""

import numpy as np

from tilenca.shapes.form import make_form
from tilenca.shapes.lattice import random_skeleton
from tilenca.shapes.vary import Vary


def test_random_skeletons_are_connected_within_the_unit_square_and_by_seed() -> None:
    random, again = np.random.default_rng(1), np.random.default_rng(1)
    shapes = set()
    for _ in range(200):
        skeleton, same = random_skeleton(random), random_skeleton(again)
        assert skeleton.edges == same.edges
        assert skeleton.points.min() >= 0
        assert skeleton.points.max() <= 1
        assert skeleton.degree.min() >= 1
        reached = {0}
        while more := {b for edge in skeleton.edges for b in edge if reached & set(edge)} - reached:
            reached |= more
        assert len(reached) == len(skeleton.points)
        shapes.add((skeleton.edges, skeleton.points.tobytes()))
    assert len(shapes) > 150


def test_most_of_them_can_be_drawn() -> None:
    random = np.random.default_rng(2)
    drawn = [make_form(random_skeleton(random), Vary(), random).draw((9, 7)) for _ in range(100)]
    assert sum(rows is not None for rows in drawn) > 50
