"""The undisturbed pool runs on with the EMA weights, as in the fast simulator, and nothing else changes."""

from copy import deepcopy
from dataclasses import fields, replace

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.model.file import Dimensions, load_model
from tilenca.model.initial import initial_arrays
from tilenca.model.quantise import quantise
from tilenca.shapes.batch import load_training_task
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.training.curriculum import build
from tilenca.training.pool import CONVERGED_AFTER, Pool, Pools
from tilenca.training.pool_refresh import (
    CLOCKS,
    MOST_HARD_EXAMPLES,
    REFRESHED,
    mine_hard_examples,
    refresh_undisturbed,
)
from tilenca.training.recipes import RECIPES

MODEL = load_model(paths.MODELS / "digits-drawn")


@pytest.fixture(scope="module")
def pools() -> Pools:
    recipe = replace(RECIPES["smoke"], unknown=0.0, damaged=0.0, varied=0.0, unlabelled=0.0)
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], recipe.stretch, 20)
    task = replace(task, labels=MODEL.labels)
    random = np.random.default_rng(1)
    return Pools(recipe, build(task, recipe, sizes, random), 21, random)


def refreshed(pools: Pools, pool: Pool, steps: tuple[int, int], seed: int = 3) -> Pool:
    pool = deepcopy(pool)
    refresh_undisturbed(MODEL, pool, pools.drawings, steps, np.random.default_rng(seed))
    return pool


def test_seeds_of_digits_become_digits_that_agree(pools: Pools) -> None:
    old = refreshed(pools, pools.undisturbed, (100, 100))
    assert (old.age > pools.undisturbed.age).all()
    assert np.array_equal(old.drawing, pools.undisturbed.drawing)
    for number, drawing in enumerate(old.drawing):
        size = pools.drawings.sizes[drawing]
        scores = old.states[number, :size, -len(MODEL.labels) :]
        assert (scores.argmax(axis=1) == pools.drawings.classes[drawing]).all()
        assert not old.states[number, size:].any(), "unused places stay empty"


def test_states_go_through_integers_and_back_unharmed(pools: Pools) -> None:
    old = refreshed(pools, pools.undisturbed, (40, 40))
    random = np.random.default_rng(3)
    random.uniform()  # the number of steps
    order = random.permutation(len(old.drawing))
    engine = FastEngine(MODEL)
    seeds = engine.seed(int(pools.drawings.sizes[old.drawing].sum()))
    simulator = Simulator(engine, pools.drawings, old.drawing[order], CLOCKS, random, seeds)
    simulator.run(40)
    batch = simulator.batch
    assert np.array_equal(old.states[order[batch.sample], batch.place] * 8192, simulator.states)


def test_only_some_grids_of_a_large_pool_run_at_once(pools: Pools) -> None:
    several = -(-2 * REFRESHED // len(pools.undisturbed.age))
    large = Pool(*(np.concatenate([getattr(pools.undisturbed, f.name)] * several) for f in fields(Pool)))
    old = refreshed(pools, large, (5, 5))
    assert (old.age != large.age).sum() == REFRESHED


def test_the_number_of_steps_is_drawn_and_the_same_seed_draws_the_same(pools: Pools) -> None:
    ages = [refreshed(pools, pools.undisturbed, (5, 200), seed) for seed in (1, 1, 2)]
    assert np.array_equal(ages[0].states, ages[1].states)
    assert not np.array_equal(ages[0].age, ages[2].age)


def test_what_does_not_agree_goes_into_the_busy_pool(pools: Pools) -> None:
    pools = deepcopy(pools)
    before = deepcopy(pools.perturbed)
    size = Dimensions(21, 12, 12)
    learnt_nothing, _ = quantise(size, MODEL.labels, initial_arrays(size, np.random.default_rng(1)), {})
    assert mine_hard_examples(learnt_nothing, pools, 4, np.random.default_rng(2)) > 10
    new = np.flatnonzero(
        (pools.perturbed.states != before.states).any(axis=(1, 2)) | (pools.perturbed.age != before.age)
    )
    assert 0 < len(new) <= MOST_HARD_EXAMPLES * len(before.age)
    for number in new:
        drawing = pools.perturbed.drawing[number]
        cells = pools.perturbed.states[number, : pools.drawings.sizes[drawing]]
        assert pools.perturbed.age[number] == CONVERGED_AFTER
        assert (cells[:, -len(MODEL.labels) :].argmax(axis=1) != pools.drawings.classes[drawing]).any()


def test_a_good_model_is_hardly_ever_stuck(pools: Pools) -> None:
    pools = deepcopy(pools)
    assert mine_hard_examples(MODEL, pools, 20, np.random.default_rng(2)) <= 5
