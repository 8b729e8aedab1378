"""From one drawing to another while tiles run."""

from itertools import pairwise

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.model.file import Model, load_model
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.shapes.cells import connected
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.transitions import rebuild, rebuild_tile_by_tile


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model(paths.DEFAULT_MODEL)


@pytest.fixture(scope="module")
def digits(model: Model) -> Drawings:
    return load_drawings([paths.DEFAULT_SHAPES], labels=model.labels)


@pytest.mark.parametrize("change", [rebuild, rebuild_tile_by_tile], ids=["at once", "tile by tile"])
def test_running_tiles_rebuilt_into_another_digit_name_it(
    change: object, model: Model, digits: Drawings
) -> None:
    assert callable(change)
    changed = change(FastEngine(model), digits, 1, 60, 60, np.random.default_rng(1))
    assert changed is not None
    trajectory, new = changed
    assert len(new) == 90
    assert (np.bincount(new) == 9).all()
    assert trajectory.agreed[-1].mean() > 0.95


def test_one_class_alone_has_nothing_to_be_rebuilt_into(model: Model, digits: Drawings) -> None:
    assert rebuild(FastEngine(model), digits.chosen([4]), 1, 5, 5, np.random.default_rng(1)) is None
    assert (
        rebuild_tile_by_tile(FastEngine(model), digits.chosen([4]), 1, 5, 5, np.random.default_rng(1)) is None
    )


def test_on_the_way_from_one_drawing_to_another_tiles_hang_together(digits: Drawings) -> None:
    from tilenca.simulator.transitions import _walk

    random = np.random.default_rng(3)
    for old in range(10):
        for new in range(10):
            steps = list(_walk(digits, old, new, random))
            assert set(steps[0]) == set(digits.shapes[old].cells)
            assert len(steps[-1]) == len(digits.shapes[new].cells)
            for before, after in pairwise(steps):
                assert len(set(before) ^ set(after)) == 1
                assert connected(after)
