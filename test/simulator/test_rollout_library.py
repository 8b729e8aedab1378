"""The schedule of rollouts, tick by tick; test_simulator.py compares the states with a slow simulator."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from tilenca.simulator.rollout_library import (
    SCHEDULES,
    TICKS_PER_STEP,
    UNITS_PER_STEP,
    Clocks,
    Setup,
    Tick,
    TickSchedule,
    units,
)

CELLS, STEPS = 3, 40
# A line of three tiles from west to east.
NONE = CELLS
LINE = np.array([[NONE, 1, NONE, NONE], [NONE, 2, NONE, 0], [NONE, NONE, NONE, 1]])


def setup(
    schedule: str, loss: float = 0.0, alive: tuple[bool, ...] = (True,) * CELLS, running: bool = False
) -> Setup:
    """A line of tiles that update at half past, the first ones being switched on half a step before 0."""
    half, whole, tenth = (np.full(CELLS, value) for value in (0.5, 1.0, 0.1))
    return Setup(
        np.array([0, CELLS]), LINE, np.array(alive), np.zeros(CELLS, np.int64), np.array([7], np.uint64),
        loss, True, schedule, Clocks(half, whole, tenth, -1.0) if schedule == "clock" else None, running,
        "none", np.array([-1]), 0, 0, np.zeros((0, 3), np.int32),
    )  # fmt: skip


def ticks(given: Setup) -> list[Tick]:
    """The ticks of STEPS steps."""
    schedule, found, steps = TickSchedule(given), list[Tick](), 0
    while steps < STEPS:
        found.append(schedule.next())
        steps += found[-1].last
        assert len(found) <= (STEPS + 1) * TICKS_PER_STEP, "a step more for those switched on before"
    return found


def updates(found: list[Tick]) -> list[int]:
    done = np.concatenate([tick.updating for tick in found])
    return [int((done == cell).sum()) for cell in range(CELLS)]


def test_times_are_whole_units_to_the_nearest() -> None:
    assert units(1.0) == UNITS_PER_STEP
    assert units(np.array([0.0, 0.5, 2.0])).tolist() == [0, UNITS_PER_STEP // 2, 2 * UNITS_PER_STEP]
    assert units(0.6 / UNITS_PER_STEP) == 1


def test_on_clocks_each_tile_updates_once_a_step_and_is_heard_after_its_latency() -> None:
    found = ticks(setup("clock"))
    assert updates(found) == [STEPS] * CELLS
    own = [number for number, tick in enumerate(found) if 0 in tick.updating]
    arrived = [number for number, tick in enumerate(found) if 0 in tick.senders]
    latency = TICKS_PER_STEP // 10
    assert set(np.diff(own)) == {TICKS_PER_STEP}
    sent = [own[0] - TICKS_PER_STEP, *own]  # the seed first
    assert arrived == [number + latency for number in sent if number + latency < len(found)]


def arrivals(found: list[Tick], cell: int, side: int) -> list[int]:
    """The ticks in which a cell's message arrives at a side."""
    return [
        number
        for number, tick in enumerate(found)
        if cell in tick.senders and tick.arrives[tick.senders == cell, side].any()
    ]


def on_other_clocks(**times: Any) -> list[Tick]:
    given = setup("clock")
    assert given.clocks is not None
    return ticks(replace(given, clocks=replace(given.clocks, **times)))


def test_a_message_arrives_at_each_side_after_its_own_latency_and_the_seed_after_its() -> None:
    latency = np.tile([0.1, 0.2, 0.3, 0.7], (CELLS, 1))
    found = on_other_clocks(latency=latency, seed_latency=latency / 2)
    own = [number for number, tick in enumerate(found) if 1 in tick.updating]
    for side, parts in ((1, 4), (3, 14)):
        seed, *others = arrivals(found, 1, side)
        assert seed == own[0] - TICKS_PER_STEP + parts // 2
        assert others == [number + parts for number in own if number + parts < len(found)]


def test_a_latency_for_all_sides_is_the_same_as_one_of_each() -> None:
    for one, other in zip(
        ticks(setup("clock", loss=0.3)), on_other_clocks(latency=np.full((CELLS, 4), 0.1)), strict=True
    ):
        np.testing.assert_array_equal(one.arrives, other.arrives)


def test_a_tile_does_not_hear_a_message_that_was_on_its_line_when_it_was_switched_on() -> None:
    first = np.array([0.5, 0.65, 2.5])  # the middle one is switched on 0.15 after the first
    for line, heard in ((0.1, False), (0.2, False), (0.04, True)):
        found = on_other_clocks(first=first, latency=np.full(CELLS, 0.2), line=np.full(4, line))
        own = [number for number, tick in enumerate(found) if 0 in tick.updating]
        assert (arrivals(found, 0, 1)[0] == own[0] - TICKS_PER_STEP + 4) == heard, line
        assert own[0] + 4 in arrivals(found, 0, 1)


def test_a_message_arrives_at_neighbours_only() -> None:
    for tick in ticks(setup("clock")):
        for cell, sides in zip(tick.senders, tick.arrives, strict=True):
            assert sides.tolist() == (LINE[cell] != NONE).tolist()


def test_by_random_halves_a_step_has_one_update_per_tile_on_average() -> None:
    found = ticks(setup("random"))
    assert 0.6 * STEPS * CELLS < sum(updates(found)) < 1.4 * STEPS * CELLS


def test_the_listing_draws_one_tile_after_another_as_many_in_a_step_as_there_are() -> None:
    found = ticks(setup("listing"))
    assert sum(updates(found)) == STEPS * CELLS
    assert max(len(tick.updating) for tick in found) == 1
    assert len(set(updates(found))) > 1, "with replacement: not every tile is drawn equally often"


def test_by_the_listing_neighbours_have_an_update_before_the_next_one() -> None:
    found = ticks(setup("listing"))
    for before, after in pairwise(found):
        assert after.senders.tolist() == before.updating.tolist()
    assert found[0].senders.tolist() == [0, 1, 2], "and they know the states that all begin with"
    for last in (tick for tick in found if tick.last):
        assert not len(last.updating), "the last update of a step arrives within the step"


def test_a_tile_sends_its_seed_when_it_is_switched_on_and_updates_a_period_later() -> None:
    found = ticks(setup("clock"))
    [born] = [number for number, tick in enumerate(found) if 0 in tick.born]
    sent = next(number for number, tick in enumerate(found) if 0 in tick.senders)
    first = next(number for number, tick in enumerate(found) if 0 in tick.updating)
    assert sent == born + TICKS_PER_STEP // 10, "its latency"
    assert first == born + TICKS_PER_STEP


def test_tiles_that_run_already_are_not_switched_on_and_are_known_at_once() -> None:
    found = ticks(setup("clock", running=True))
    assert not any(len(tick.born) for tick in found)
    assert found[0].senders.tolist() == [0, 1, 2]


def test_a_change_switches_tiles_at_the_beginning_of_its_step() -> None:
    for schedule in SCHEDULES:
        changes = np.array([[2, 1, 0], [5, 1, 1], [5, 0, 1]], np.int32)
        found = ticks(replace(setup(schedule, alive=(False, True, True)), changes=changes))
        starts = [0] + [number + 1 for number, tick in enumerate(found) if tick.last]
        switched = [
            (step, sorted(tick.gone.tolist()), sorted(tick.born.tolist()))
            for step, tick in enumerate(found[start] for start in starts[:STEPS])
            if len(tick.gone) or (step > 0 and len(tick.born))
        ]
        assert switched == [(2, [1], []), (5, [], [0, 1])]
        there = [any(1 in tick.updating for tick in found[a:b]) for a, b in pairwise(starts)]
        assert not any(there[2:5])
        assert any(there[5:])


def test_where_all_messages_are_lost_every_side_reads_as_zeros_and_elsewhere_none() -> None:
    for schedule in SCHEDULES:
        assert all(tick.absent.all() for tick in ticks(setup(schedule, loss=1.0)))
        assert not any(tick.absent.any() for tick in ticks(setup(schedule, loss=0.0)))
        some = np.concatenate([tick.absent.ravel() for tick in ticks(setup(schedule, loss=0.3))])
        assert 0.2 < some.mean() < 0.4


def test_a_dead_tile_neither_updates_nor_sends() -> None:
    found = ticks(setup("clock", alive=(True, False, True)))
    assert updates(found) == [STEPS, 0, STEPS]
    assert not any(1 in tick.senders for tick in found)


def test_the_same_seed_is_the_same_schedule() -> None:
    first, again = ticks(setup("random", loss=0.3)), ticks(setup("random", loss=0.3))
    assert len(first) == len(again)
    for one, other in zip(first, again, strict=True):
        for name in ("senders", "arrives", "updating", "absent"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
