"""The grids that training goes on from."""

from dataclasses import replace

import numpy as np
import pytest

from support.training import DAMAGE, SMOKE, trainer
from tilenca.base import paths
from tilenca.shapes.batch import load_drawings
from tilenca.training.curriculum import DRAWN, Curriculum
from tilenca.training.pool import CONVERGED_AFTER, PATIENCE, Pools


def test_pools_hold_states_of_their_drawings_only() -> None:
    learner = trainer()
    for _ in range(30):
        learner.step()
    for pool in (learner.pools.perturbed, learner.pools.undisturbed):
        sizes = learner.pools.drawings.sizes[pool.drawing]
        for states, size in zip(pool.states, sizes, strict=True):
            assert not states[size:].any()
        assert np.abs(pool.states).max() <= 127 / 64


def test_rebuilt_tissues_keep_the_states_of_tiles_that_stay() -> None:
    drawings = load_drawings([paths.DEFAULT_SHAPES])
    some = len(drawings)
    even = Curriculum(drawings, np.full(some, DRAWN), np.full(some, 1 / some), np.arange(some))
    pools = Pools(SMOKE, even, 21, np.random.default_rng(1))
    four, nine = 4, 9  # every tile of the "4" is a tile of the "9"
    kept, all_of_nine = int(drawings.sizes[four]), int(drawings.sizes[nine])
    for _ in range(200):
        pools.perturbed.drawing[0] = four
        pools.perturbed.states[0] = 0
        pools.perturbed.states[0, :kept, 3] = 0.25
        pools.switch(pools.perturbed, 0)
        if pools.perturbed.drawing[0] == nine:
            break
    assert pools.perturbed.drawing[0] == nine
    assert (pools.perturbed.states[0, :all_of_nine, 3] == 0.25).sum() == kept
    assert (pools.perturbed.states[0, :all_of_nine, 0] == 1.0).sum() == all_of_nine - kept
    assert not pools.perturbed.states[0, all_of_nine:].any()


def test_a_grid_that_does_not_agree_is_left_alone_until_it_does_or_time_is_up() -> None:
    learner = trainer()
    pools = learner.pools
    count = SMOKE.batch - SMOKE.undisturbed_batch
    disturbed = sum(round(share * count) for share in (SMOKE.reset, SMOKE.switch, SMOKE.state_shuffle))
    wrong = np.arange(len(pools.perturbed.age)) % 3 == 0
    for _ in range(20):
        pools.perturbed.wrong[:] = wrong
        pools.perturbed.age[:] = 200
        taken = pools.take(0.5).perturbed
        others = int((~wrong[taken]).sum())
        assert (pools.perturbed.age[taken] == 0).sum() == disturbed
        assert (pools.perturbed.age[taken[wrong[taken]]] == 0).sum() == max(0, disturbed - others)
    pools.perturbed.wrong[:], pools.perturbed.age[:] = True, PATIENCE
    assert (pools.perturbed.age[pools.take(0.5).perturbed] == 0).sum() == disturbed, "time is up"


def test_whether_a_grid_agrees_is_noted_only_after_it_had_time() -> None:
    learner = trainer()
    learner.step()
    assert not learner.pools.perturbed.wrong.any(), "all began a moment ago"
    for _ in range(15):
        learner.step()
    assert learner.pools.perturbed.wrong.any()
    assert (learner.pools.perturbed.age[learner.pools.perturbed.wrong] >= CONVERGED_AFTER).all()


def test_failures_of_one_record_count_by_their_mean() -> None:
    learner = trainer()
    pools = learner.pools
    pools.perturbed.age[:] = CONVERGED_AFTER
    taken = pools.take(0.5)
    same = np.zeros_like(pools.curriculum.failing)
    pools.curriculum = replace(pools.curriculum, failing=same)
    pools.perturbed.age[taken.perturbed] = 0
    ticks = np.full(SMOKE.batch, CONVERGED_AFTER)
    right = np.arange(SMOKE.batch) % 2 == 0
    pools.failures[0] = 0.5
    pools.give_back(taken, taken.states, ticks, right)
    converged = pools.perturbed.age[taken.perturbed] >= CONVERGED_AFTER
    share = (~right[: len(taken.perturbed)])[converged].mean()
    assert pools.failures[0] == pytest.approx(0.5 + 0.1 * (share - 0.5))


def test_rebuilt_grids_may_have_been_settled_for_long_before() -> None:
    recipe = replace(SMOKE, reset=0.0, switch=1.0, state_shuffle=0.0, settled=1.0)
    pools = trainer(recipe=recipe).pools
    pools.undisturbed.states[:, :, 5] = 0.5  # none of the others has this
    taken = pools.take(0.5).perturbed
    assert (pools.perturbed.states[taken, :, 5] == 0.5).any(axis=1).mean() > 0.8
    assert (pools.perturbed.age[taken] == 0).all()
    none = trainer(recipe=replace(recipe, settled=0.0)).pools
    none.undisturbed.states[:, :, 5] = 0.5
    assert not (none.perturbed.states[none.take(0.5).perturbed, :, 5] == 0.5).any()


def test_undisturbed_grids_that_went_wrong_are_taken_first() -> None:
    recipe = replace(SMOKE, undisturbed_pool=40, undisturbed_batch=10, batch=16)
    pools = trainer(recipe=recipe).pools
    pools.undisturbed.lifetime[:] = 10**6
    wrong = [3, 17]
    pools.undisturbed.wrong[wrong] = True
    for _ in range(20):
        taken = pools.take(0.5).undisturbed
        assert set(wrong) <= set(taken.tolist())
        assert len(set(taken.tolist())) == 10
    pools.undisturbed.wrong[:20] = True
    some = [int((pools.take(0.5).undisturbed < 20).sum()) for _ in range(50)]
    assert np.mean(some) < 8, "most of a batch are any grids"


def test_where_directions_are_trained_grids_are_rebuilt_by_one_tile() -> None:
    """Every rebuilt grid that has such a drawing gets one; so a tile is missing, or is back."""
    learner = trainer(recipe=DAMAGE)
    pools = learner.pools
    changed = 0
    for number in range(len(pools.perturbed.drawing)):
        old = int(pools.perturbed.drawing[number])
        near = pools.curriculum.with_one_tile_changed(old)
        pools.switch(pools.perturbed, number)
        if len(near):
            new = int(pools.perturbed.drawing[number])
            assert new in near
            assert abs(int(pools.drawings.sizes[new]) - int(pools.drawings.sizes[old])) == 1
            changed += 1
    assert changed > 3
