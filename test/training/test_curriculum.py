"""What a training shows: every kind of drawing in its share, and nothing that is held out."""

from dataclasses import replace

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.evaluation.suites import make_suite
from tilenca.shapes import variants
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import UNKNOWN
from tilenca.shapes.stretch import smallest
from tilenca.training.curriculum import build, labels_of
from tilenca.training.recipes import RECIPES, aims_of

FULL = replace(RECIPES["full"], stretch=1.5)


def test_the_curriculum_has_every_kind_in_its_share_and_nothing_held_out() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    task = replace(task, labels=labels_of(task, FULL, 20))
    curriculum = build(task, FULL, sizes, np.random.default_rng(1))
    shapes, weights = curriculum.drawings.shapes, curriculum.weights
    assert weights.sum() == pytest.approx(1)
    unknown = np.array([shape.label == UNKNOWN for shape in shapes])
    damaged = np.array([shape.name.endswith("damaged") for shape in shapes])
    assert weights[unknown].sum() == pytest.approx(FULL.unknown)
    assert weights[damaged].sum() == pytest.approx(FULL.damaged)
    assert {shape.label for shape in shapes} == {*"0123456789", UNKNOWN}
    made = [shape for shape, some in zip(shapes, unknown | damaged, strict=True) if some]
    assert not any(variants.held_out(shape.rows) for shape in made)
    asked = make_suite(task, sizes, task.labels, aims_of(FULL), seed=1)
    cases = (*asked.sizes, *asked.damaged, *asked.unknown)
    new = {s.rows for case in cases if case.held_out for s in case.drawings.shapes}
    assert new.isdisjoint(shape.rows for shape in shapes)
    forms = {smallest(shape.rows) for shape in shapes}
    for case in (*asked.damaged, *asked.unknown):
        if case.held_out:
            assert forms.isdisjoint(smallest(shape.rows) for shape in case.drawings.shapes), case.name
    drawn = {(len(shape.rows), len(shape.rows[0])) for shape in shapes if shape.label == "8"}
    assert (7, 6) in drawn
    assert not drawn & set(sizes.held_out)
    assert max(rows for rows, _ in drawn) <= 1.5 * 5, "the recipe stretches half as much again at most"


def test_the_same_seed_draws_the_same_curriculum() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    task = replace(task, labels=labels_of(task, FULL, 20))
    one, same, other = (
        [s.rows for s in build(task, FULL, sizes, np.random.default_rng(seed)).drawings.shapes]
        for seed in (1, 1, 2)
    )
    assert one == same
    assert one != other


def test_a_state_without_room_for_a_dash_gets_none() -> None:
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    assert labels_of(task, FULL, 11) == (*"0123456789", UNKNOWN)
    assert labels_of(task, FULL, 10) == tuple("0123456789")
    assert labels_of(task, replace(FULL, unknown=0.0), 20) == tuple("0123456789")
