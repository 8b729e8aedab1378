"""From one drawing to another while tiles run."""

from typing import get_args

import numpy as np
import pytest

from support.restless_grids import MODEL as RESTLESS
from tilenca.base import paths
from tilenca.model.file import Model, load_model
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.shapes.cells import connected
from tilenca.shapes.file import Shape
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.transitions import Order, Way, rebuild, walk

ORDERS: tuple[Order, ...] = get_args(Order)


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model(paths.DEFAULT_MODEL)


@pytest.fixture(scope="module")
def digits(model: Model) -> Drawings:
    return load_drawings([paths.DEFAULT_SHAPES], labels=model.labels)


@pytest.mark.parametrize("order", ORDERS)
def test_running_tiles_rebuilt_into_another_digit_name_it(
    order: Order, model: Model, digits: Drawings
) -> None:
    changed = rebuild(FastEngine(model), digits, 1, 60, 60, np.random.default_rng(1), Way(order, 3))
    assert changed is not None
    assert (np.bincount(changed.chosen) == 9).all()
    assert changed.trajectory.right.shape == (60, 90)
    assert changed.trajectory.agreed[-1].mean() > 0.95
    right = changed.answers == digits.classes[changed.chosen]
    assert (right == changed.trajectory.agreed[-1]).all()


def test_one_class_alone_has_nothing_to_be_rebuilt_into(model: Model, digits: Drawings) -> None:
    for order in ORDERS:
        way = Way(order)
        assert rebuild(FastEngine(model), digits.chosen([4]), 1, 5, 5, np.random.default_rng(1), way) is None


def test_steps_count_from_the_last_change_and_old_messages_last_six_periods(
    model: Model, digits: Drawings
) -> None:
    """A "7" becomes a "1" when three tiles are taken away; what is left cannot know at once."""
    seven_to_one = digits.chosen([7, 1])
    changed = rebuild(FastEngine(model), seven_to_one, 50, 60, 60, np.random.default_rng(1))
    assert changed is not None
    to_one = changed.chosen == 1
    times = changed.trajectory.converged_at[to_one]
    assert 6 <= np.median(times) <= 18
    assert times.min() > 2


def test_tiles_that_are_not_there_are_not_counted() -> None:
    """A line of three that loses two tiles has one tile, which shows one class: it is right or it is not."""
    shapes = (Shape("0", ("###",), "0"), Shape("1", ("#",), "1"))
    lines = Drawings(shapes, (0, 0), ("0", "1", "2"), ({"file": "lines.toml", "sha256": ""},))
    changed = rebuild(FastEngine(RESTLESS), lines, 40, 10, 30, np.random.default_rng(1))
    assert changed is not None
    shares = changed.trajectory.right
    assert set(np.unique(shares[:, changed.chosen == 1])) <= {0.0, 1.0}
    assert len(np.unique(shares[:, changed.chosen == 0])) > 2


def test_each_order_of_changes_keeps_the_tiles_connected_and_is_what_it_says(digits: Drawings) -> None:
    random = np.random.default_rng(3)
    cells = [set(shape.cells) for shape in digits.shapes]
    mixed = 0
    for old in cells:
        for new in cells:
            for order in ORDERS[1:]:
                if not old & new:
                    continue
                tiles, kinds = set(old), []
                for [(cell, on)] in walk(old, new, order, random):
                    assert (cell not in tiles) == on
                    tiles ^= {cell}
                    kinds.append(on)
                    assert connected(tiles)
                assert tiles == new
                if order == "adding first":
                    assert kinds == sorted(kinds, reverse=True)
                mixed += order == "mixed" and kinds != sorted(kinds) and kinds != sorted(kinds, reverse=True)
    assert mixed > 20


def test_removing_first_adds_only_where_nothing_can_be_taken_away() -> None:
    """The old tile in the middle holds the others together until the new ones do."""
    old, new = {(0, 0), (0, 1), (0, 2)}, {(0, 0), (1, 0), (1, 1), (1, 2), (0, 2)}
    kinds = [on for [(_, on)] in walk(old, new, "removing first", np.random.default_rng(1))]
    assert kinds == [True, True, True, False]
    corner = {(0, 0), (0, 1), (1, 0)}
    kinds = [on for [(_, on)] in walk(old, corner, "removing first", np.random.default_rng(1))]
    assert kinds == [False, True]
