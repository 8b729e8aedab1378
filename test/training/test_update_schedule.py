"""Who updates when, and who hears whom."""

from dataclasses import replace

import numpy as np

from support.training import usual
from tilenca.shapes.batch import Drawings
from tilenca.training.recipes import RECIPES
from tilenca.training.update_schedule import draw_schedule


def test_tiles_on_clocks_update_once_per_period_and_are_heard_after_their_latency(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], clocks=1.0, lossy=0.0, ticks_per_period=(4.0, 4.0), drift=0.0)
    recipe = replace(recipe, latency=(0.5, 0.5))
    batch = drawings.batch(np.array([0]))
    schedule = draw_schedule(
        recipe,
        batch,
        np.array([41]),
        np.random.default_rng(3),
        usual(batch),
    )
    fired, arrived, _ = schedule.by_cell()
    for cell in range(len(batch.sample)):
        fires, arrives = (np.flatnonzero(what[:, cell]) for what in (fired, arrived))
        assert set(np.diff(fires)) == {4}
        assert {(a - fires[fires <= a].max()) for a in arrives if a >= fires[0]} == {2}


def test_a_tile_is_nobody_until_its_first_message_has_arrived(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=0.0, clocks=1.0, stale=1.0, max_stale=0.9)
    batch = drawings.batch(np.array([8]))
    cells = len(batch.sample)
    fresh = np.arange(cells) % 2 == 0
    schedule = draw_schedule(
        recipe, batch, np.array([60]), np.random.default_rng(3), usual(batch, fresh=fresh)
    )
    fires, arrives, neighbours = schedule.by_cell()
    sent = np.logical_or.accumulate(fires) & arrives
    known = np.logical_or.accumulate(np.vstack((~fresh, sent[:-1])))
    before = 0
    for now, cell in np.argwhere(fires):
        for side, other in enumerate(batch.neighbours[cell]):
            if other < cells:
                assert neighbours[now, cell, side] == (other if known[now, other] else cells)
                before += not known[now, other]
    assert before > 10


def test_lost_messages_read_as_nobody(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=1.0, max_loss=1.0, longest_loss=1)
    batch = drawings.batch(np.arange(len(drawings)))
    lengths = np.full(len(drawings), 50)
    schedule = draw_schedule(
        recipe,
        batch,
        lengths,
        np.random.default_rng(3),
        usual(batch),
    )
    fires, _, neighbours = schedule.by_cell()
    lost = fires[:, :, None] & (neighbours != batch.neighbours)
    assert (neighbours[lost] == len(batch.sample)).all()
    asked = fires[:, :, None] & (batch.neighbours < len(batch.sample))
    assert 0.2 < lost.sum() / asked.sum() < 0.8


def test_a_loss_may_last(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=1.0, max_loss=1.0, fire_rate=(1.0, 1.0), clocks=0.0)
    batch = drawings.batch(np.array([8]))

    def changes(longest: int) -> float:
        """How often a neighbour is heard after it was not, or the other way round."""
        some = replace(recipe, longest_loss=longest)
        random = np.random.default_rng(5)
        schedules = [draw_schedule(some, batch, np.array([60]), random, usual(batch)) for _ in range(30)]
        heard = [schedule.by_cell()[2] < len(batch.sample) for schedule in schedules]
        return float(np.mean([np.diff(one.astype(np.int8), axis=0) != 0 for one in heard]))

    assert changes(12) < 0.5 * changes(1)


def test_nobody_updates_before_being_switched_on_or_after_the_end_of_its_life(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=0.0, fire_rate=(1.0, 1.0), clocks=0.0)
    batch = drawings.batch(np.array([0, 0]))
    schedule = draw_schedule(
        recipe,
        batch,
        np.array([20, 30]),
        np.random.default_rng(3),
        usual(batch, staggered=np.array([True, False])),
    )
    fires, _, neighbours = schedule.by_cell()
    late, prompt = fires[:, batch.sample == 0], fires[:, batch.sample == 1]
    assert not late[20:].any()
    assert prompt[:30].all()
    first = np.argmax(late, axis=0)
    assert len(set(first.tolist())) > 3, "tiles are switched on at different times"
    for cell, begin in enumerate(first):
        for side, other in enumerate(batch.neighbours[cell]):
            if other < len(first) and first[other] > begin:
                asleep = neighbours[begin : first[other], cell, side]
                assert (asleep == len(batch.sample)).all(), "a tile that is off was heard"


def test_any_number_of_threads_and_parts_lives_the_same_life(drawings: Drawings) -> None:
    random = np.random.default_rng(11)
    batch = drawings.batch(random.integers(len(drawings), size=9))
    lengths = np.full(9, 10)
    schedule = draw_schedule(
        RECIPES["full"], batch, lengths, random, usual(batch, staggered=random.random(9) < 0.3)
    )
    whole = schedule.by_cell()
    for wanted in (1, 2, 5, 40):
        parts = list(schedule.parts(wanted))
        assert len(parts) == wanted
        for part, (cells, some) in enumerate(parts):
            fires, arrives, neighbours = some.by_cell()
            size = cells.stop - cells.start
            assert np.array_equal(fires, whole[0][:, cells]), part
            assert np.array_equal(arrives, whole[1][:, cells])
            away = np.where(neighbours == size, len(batch.sample), neighbours + cells.start)
            assert np.array_equal(away, whole[2][:, cells])
