"""The schedule of rollouts, tick by tick; test_simulator.py compares the states with a slow simulator."""

import numpy as np

from tilenca.simulator.rollout_library import TICKS_PER_STEP, UNITS_PER_STEP, Setup, Tick, TickSchedule, units

CELLS, STEPS = 3, 40
# A line of three tiles from west to east.
NONE = CELLS
LINE = np.array([[NONE, 1, NONE, NONE], [NONE, 2, NONE, 0], [NONE, NONE, NONE, 1]])


def setup(clocks: bool, loss: float = 0.0, alive: tuple[bool, ...] = (True,) * CELLS) -> Setup:
    half, whole, tenth = (np.full(CELLS, value) for value in (0.5, 1.0, 0.1))
    return Setup(
        np.array([0, CELLS]), LINE, np.array(alive), np.zeros(CELLS, np.int64), np.array([7], np.uint64),
        loss, True, (half, whole, tenth, 0.0) if clocks else None, "none", np.array([-1]), 0, 0,
    )  # fmt: skip


def ticks(given: Setup) -> list[Tick]:
    """The ticks of STEPS steps."""
    schedule, found, steps = TickSchedule(given), list[Tick](), 0
    while steps < STEPS:
        found.append(schedule.next())
        steps += found[-1].last
        assert len(found) <= STEPS * TICKS_PER_STEP
    return found


def updates(found: list[Tick]) -> list[int]:
    done = np.concatenate([tick.updating for tick in found])
    return [int((done == cell).sum()) for cell in range(CELLS)]


def test_times_are_whole_units_to_the_nearest() -> None:
    assert units(1.0) == UNITS_PER_STEP
    assert units(np.array([0.0, 0.5, 2.0])).tolist() == [0, UNITS_PER_STEP // 2, 2 * UNITS_PER_STEP]
    assert units(0.6 / UNITS_PER_STEP) == 1


def test_on_clocks_each_tile_updates_once_a_step_and_is_heard_after_its_latency() -> None:
    found = ticks(setup(clocks=True))
    assert updates(found) == [STEPS] * CELLS
    own = [number for number, tick in enumerate(found) if 0 in tick.updating]
    arrived = [number for number, tick in enumerate(found) if 0 in tick.senders]
    latency = TICKS_PER_STEP // 10
    assert set(np.diff(own)) == {TICKS_PER_STEP}
    assert arrived == [number + latency for number in own if number + latency < len(found)]


def test_a_message_arrives_at_neighbours_only() -> None:
    for tick in ticks(setup(clocks=True)):
        for cell, sides in zip(tick.senders, tick.arrives, strict=True):
            assert sides.tolist() == (LINE[cell] != NONE).tolist()


def test_by_the_papers_sampler_a_step_has_one_update_per_tile_on_average() -> None:
    found = ticks(setup(clocks=False))
    assert 0.6 * STEPS * CELLS < sum(updates(found)) < 1.4 * STEPS * CELLS


def test_where_all_messages_are_lost_every_side_reads_as_zeros_and_elsewhere_none() -> None:
    for clocks in (True, False):
        assert all(tick.absent.all() for tick in ticks(setup(clocks, loss=1.0)))
        assert not any(tick.absent.any() for tick in ticks(setup(clocks, loss=0.0)))
        some = np.concatenate([tick.absent.ravel() for tick in ticks(setup(clocks, loss=0.3))])
        assert 0.2 < some.mean() < 0.4


def test_a_dead_tile_neither_updates_nor_sends() -> None:
    found = ticks(setup(clocks=True, alive=(True, False, True)))
    assert updates(found) == [STEPS, 0, STEPS]
    assert not any(1 in tick.senders for tick in found)


def test_the_same_seed_is_the_same_schedule() -> None:
    first, again = ticks(setup(clocks=False, loss=0.3)), ticks(setup(clocks=False, loss=0.3))
    assert len(first) == len(again)
    for one, other in zip(first, again, strict=True):
        for name in ("senders", "arrives", "updating", "absent"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
