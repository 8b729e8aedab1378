"""What a training shows: every kind of drawing in its share, and nothing that is held out."""

from dataclasses import replace

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.shapes.batch import UNLABELLED, load_training_task
from tilenca.shapes.file import UNKNOWN
from tilenca.shapes.variant import TRAINED, split_of
from tilenca.training.curriculum import DRAWN, STRETCHED, Curriculum, build, labels_of
from tilenca.training.generator import DAMAGED, FREE, OF_NO_CLASS, VARIED
from tilenca.training.recipe import Recipe
from tilenca.training.recipes import RECIPES

FULL = replace(RECIPES["forms"], stretch=1.5, library=600)


def curriculum(seed: int, recipe: Recipe = FULL) -> Curriculum:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], recipe.stretch, 20)
    task = replace(task, labels=labels_of(task, recipe, 20))
    return build(task, recipe, sizes, np.random.default_rng(seed))


def test_the_curriculum_has_every_kind_in_its_share_and_nothing_held_out() -> None:
    found = curriculum(1)
    shapes, weights = found.drawings.shapes, found.weights
    assert weights.sum() == pytest.approx(1)
    for kind, share in (
        (STRETCHED, FULL.stretched),
        (VARIED, FULL.varied),
        (DAMAGED, FULL.damaged),
        (OF_NO_CLASS, FULL.unknown),
        (FREE, FULL.unlabelled),
    ):
        assert weights[found.kinds == kind].sum() == pytest.approx(share), kind
    assert found.renewable.sum() == pytest.approx(FULL.library, abs=5)
    assert {shape.label for shape in shapes} == {*"0123456789", UNKNOWN, UNLABELLED}
    files = {
        shape.rows for shape, kind in zip(shapes, found.kinds, strict=True) if kind in (DRAWN, STRETCHED)
    }
    assert all(split_of(shape.rows) == TRAINED for shape in shapes if shape.rows not in files)
    _, sizes = load_training_task([paths.DEFAULT_SHAPES], FULL.stretch, 20)
    varied = {
        (len(shape.rows), len(shape.rows[0]))
        for shape, whole in zip(shapes, found.whole, strict=True)
        if whole
    }
    assert not varied & set(sizes.held_out)
    stretched = [len(shape.rows) for shape, k in zip(shapes, found.kinds, strict=True) if k == STRETCHED]
    assert 1.5 * 5 - 1 < max(stretched) <= 1.5 * 5, "the recipe stretches half as much again at most"


def test_some_drawings_are_renewed_and_the_others_stay() -> None:
    before = curriculum(1)
    places = np.flatnonzero(before.renewable)[::3]
    after = before.renewed(places, np.random.default_rng(3))
    same = [a == b for a, b in zip(before.drawings.shapes, after.drawings.shapes, strict=True)]
    assert all(same[place] for place in range(len(same)) if place not in set(places.tolist()))
    assert not any(same[place] for place in places[:100])
    fresh = replace(after.drawings)  # nothing is cached in a copy
    for name in ("sizes", "classes", "extents"):
        assert (getattr(after.drawings, name) == getattr(fresh, name)).all()
    most = fresh.tables.shape[1]
    assert (after.drawings.tables[:, :most] == fresh.tables).all()
    assert (after.drawings.tables[:, most:] == -1).all()
    assert after.failing.max() < after.records
    assert (after.failing[~after.renewable] == before.failing[~before.renewable]).all()


def test_a_task_without_variants_or_other_kinds_consists_of_its_drawings() -> None:
    quiet = replace(FULL, varied=0.0, damaged=0.0, unknown=0.0, unlabelled=0.0, stretched=0.0)
    found = curriculum(1, quiet)
    assert found.generator is None
    assert {*found.kinds} == {DRAWN}
    assert found.renewed(np.array([1, 2]), np.random.default_rng(1)) is found


def test_the_same_seed_draws_the_same_curriculum() -> None:
    one, same, other = ([s.rows for s in curriculum(seed).drawings.shapes] for seed in (1, 1, 2))
    assert one == same
    assert one != other


def test_a_state_without_room_for_a_dash_gets_none() -> None:
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    assert labels_of(task, FULL, 11) == (*"0123456789", UNKNOWN)
    assert labels_of(task, FULL, 10) == tuple("0123456789")
    assert labels_of(task, replace(FULL, unknown=0.0), 20) == tuple("0123456789")


def test_what_is_missing_is_told_of_whole_drawings_and_of_clear_damage() -> None:
    found = curriculum(1, replace(RECIPES["damage"], stretch=1.5, library=600))
    assert found.gaps is not None
    every = np.arange(len(found.kinds))
    missing, told = found.missing(every)
    starts = np.concatenate(([0], np.cumsum(found.drawings.sizes)[:-1]))
    told, some = told[starts], np.logical_or.reduceat(missing.any(axis=1), starts)
    assert told[~found.renewable].all()
    assert not some[~found.renewable].any(), "whole drawings miss nothing"
    assert not told[found.kinds == OF_NO_CLASS].any()
    damaged = found.kinds == DAMAGED
    assert 0.6 < some[damaged].mean() < 1
    assert (some <= told).all()


def test_a_drawing_and_the_same_with_a_tile_less_know_each_other() -> None:
    found = curriculum(1, replace(RECIPES["damage"], stretch=1.5, library=600))
    pairs = 0
    for damaged in np.flatnonzero(found.kinds == DAMAGED):
        for whole in found.with_one_tile_changed(int(damaged)):
            pairs += 1
            assert found.kinds[whole] in (DRAWN, STRETCHED)
            assert found.drawings.sizes[whole] == found.drawings.sizes[damaged] + 1
            assert damaged in found.with_one_tile_changed(int(whole))
    assert pairs > 100
    assert len(curriculum(1).with_one_tile_changed(0)) == 0, "another recipe does not ask"
