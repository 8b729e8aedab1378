"""The compiled simulator: to the bit what a slow one in plain Python does, whatever goes wrong."""

from dataclasses import replace
from itertools import pairwise
from typing import Any, get_args

import numpy as np
import pytest
from numpy.typing import NDArray

from support.reference_network import reference
from support.reference_simulator import SlowRun
from support.restless_grids import (
    CONDITIONS,
    FAULTS,
    LETTERS,
    MODEL,
    TILES,
    PlainEngine,
    block,
    same,
    simulator,
)
from tilenca.simulator.conditions import Conditions, Fault, Rebuilding, ScheduleKind
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.rollout_library import TICKS_PER_STEP, TickSchedule
from tilenca.simulator.simulator import MIXED, Simulator, Trajectory

CLASSES = 3
SCHEDULES: tuple[Any, ...] = get_args(ScheduleKind)


def check_against_the_slow_one(rollout: Simulator, steps: int) -> None:
    engine = PlainEngine(MODEL)

    def update(state: NDArray[Any], inputs: NDArray[Any]) -> NDArray[Any]:
        return reference(MODEL, state, inputs).astype(np.int16)

    start = engine.seed(rollout.cells)
    slow = [
        SlowRun(rollout.setup, run, start, start[0], update, engine.message, CLASSES)
        for run in range(len(rollout.batch.starts))
    ]
    trajectory = rollout.run(steps, record=True)
    assert trajectory.shown is not None
    for step in range(steps):
        right = [run.step() for run in slow]
        assert trajectory.shown[step].tolist() == [shown for run in slow for shown in run.shown], (
            f"step {step}"
        )
        np.testing.assert_allclose(trajectory.right[step], right, rtol=1e-6)
    assert np.array_equal(rollout.states, np.concatenate([run.states for run in slow]))


@pytest.mark.parametrize("conditions", CONDITIONS, ids=str)
def test_every_state_and_display_is_that_of_the_slow_simulator(conditions: Conditions) -> None:
    check_against_the_slow_one(simulator(conditions), 30)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: f"{fault.kind}-{fault.begin}-{fault.end}")
@pytest.mark.parametrize(
    "conditions",
    [Conditions(schedule, loss=0.3, lost=lost) for schedule in SCHEDULES for lost in ("held", "zero")]
    + [Conditions(schedule, dead=0.2) for schedule in SCHEDULES],
    ids=str,
)
def test_with_a_fault_too_it_is_the_slow_simulator(fault: Fault, conditions: Conditions) -> None:
    if conditions.dead and fault.kind == "dead":
        conditions = replace(conditions, dead=0.0)  # or nobody would be left to ask in a run of three tiles
    check_against_the_slow_one(simulator(conditions, fault, seed=12), 24)


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_a_run_of_more_tiles_than_a_number_has_bits_is_the_slow_simulator_too(schedule: Any) -> None:
    check_against_the_slow_one(simulator(Conditions(schedule, loss=0.1), runs=1, drawings=block(9, 15)), 4)


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_the_result_does_not_depend_on_the_number_of_threads(schedule: Any) -> None:
    conditions = Conditions(schedule, loss=0.1)
    fault = Fault("away", np.zeros(3 * 700, np.int64), begin=2, end=4)
    rollouts = [simulator(conditions, fault, runs=700, threads=threads) for threads in (1, 2, 5)]
    assert rollouts[0].cells > 8192, "several groups, or there is nothing to share"
    assert same(rollouts[0], rollouts[1], 12)
    assert np.array_equal(rollouts[2].run(12).right, simulator(conditions, fault, runs=700).run(12).right)


def test_the_same_seed_gives_the_same_life_and_another_one_another() -> None:
    conditions = Conditions("clock", loss=0.1)
    assert same(simulator(conditions), simulator(conditions), 20)
    assert not same(simulator(conditions), simulator(conditions, seed=12), 20)


def test_a_life_goes_on_where_it_stopped() -> None:
    fault = Fault("away", TILES, begin=8, end=13)
    for schedule in SCHEDULES:
        conditions = Conditions(schedule, loss=0.2)
        whole, parts = simulator(conditions, fault), simulator(conditions, fault)
        right = np.concatenate([parts.run(steps).right for steps in (1, 7, 0, 12)])
        assert np.array_equal(whole.run(20).right, right)
        assert np.array_equal(whole.states, parts.states)


def test_ten_thousand_tiles_live_in_one_array() -> None:
    conditions = Conditions("clock", loss=0.05)
    rollouts = [
        simulator(conditions, runs=1, drawings=block(100, 100), engine=engine)
        for engine in (FastEngine, PlainEngine)
    ]
    assert rollouts[0].cells == 10_000
    assert same(rollouts[0], rollouts[1], 5)
    # Drift apart, every tile updates once a step; those switched on first are ten steps ahead.
    assert 10_000 * 5 < rollouts[0].updates < 10_000 * 15


def test_updates_are_counted() -> None:
    rollout = simulator(Conditions("clock", boot=0.0, drift=0.0))
    rollout.run(10)
    assert rollout.updates == rollout.cells * 10
    stuck = simulator(Conditions("clock", boot=0.0, drift=0.0), Fault("stuck", TILES, begin=4))
    stuck.run(10)
    assert stuck.updates == rollout.updates - 5 * 6  # five runs have a stuck tile


def test_states_to_start_from_are_copied_and_used() -> None:
    engine = FastEngine(MODEL)
    random = np.random.default_rng(1)
    states = random.integers(-16256, 16257, (12, 6)).astype(np.int16)
    before = states.copy()
    chosen = np.array([0, 2])
    rollouts = [
        Simulator(engine, LETTERS, chosen, Conditions(), np.random.default_rng(2), given, threads=1)
        for given in (states, states[::-1][::-1], engine.seed(12))
    ]
    for rollout in rollouts:
        rollout.run(3)
    assert np.array_equal(states, before)
    assert np.array_equal(rollouts[0].states, rollouts[1].states)
    assert not np.array_equal(rollouts[0].states, rollouts[2].states)


REBUILDINGS = [
    [(2, 1, 0), (5, 1, 1), (5, 9, 0), (15, 9, 1)],
    [(0, 0, 0), (0, 9, 0), (9, 0, 1)],
    [(4, cell, 0) for cell in range(0, 24, 5)] + [(20, cell, 1) for cell in range(0, 24, 5)],
]


def rebuilding(switches: list[tuple[int, int, int]]) -> Rebuilding:
    """All tiles are there from the start but every seventh, which no change puts down."""
    present = np.arange(2 * sum(LETTERS.sizes)) % 7 != 6
    return Rebuilding(present, np.array(switches, np.int32))


@pytest.mark.parametrize("switches", REBUILDINGS)
@pytest.mark.parametrize(
    "conditions",
    [Conditions(schedule, loss=loss) for schedule in SCHEDULES for loss in (0.0, 0.3)],
    ids=str,
)
def test_tiles_put_down_and_taken_away_are_as_in_the_slow_simulator(
    switches: list[tuple[int, int, int]], conditions: Conditions
) -> None:
    rollout = simulator(conditions, rebuilding=rebuilding(switches))
    check_against_the_slow_one(rollout, 24)
    there = rebuilding(switches).present
    for _, cell, on in switches:
        there[cell] = on
    assert (rollout.counted == there).all()
    assert (rollout.shown[~there] == -1).all()


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_every_engine_follows_the_same_changes(schedule: Any) -> None:
    fast, plain = (
        simulator(Conditions(schedule), engine=engine, rebuilding=rebuilding(REBUILDINGS[2]))
        for engine in (FastEngine, PlainEngine)
    )
    assert same(fast, plain, 26)


def test_a_tile_that_was_taken_away_is_heard_for_six_periods_more() -> None:
    pair = block(1, 2)
    taken = Rebuilding(np.ones(2, np.bool_), np.array([[10, 1, 0]], np.int32))
    conditions = Conditions("clock", boot=0.0, drift=0.0, latency=(0.5, 0.5))
    random = np.random.default_rng(1)
    rollout = Simulator(FastEngine(MODEL), pair, np.zeros(1, np.int64), conditions, random, rebuilding=taken)
    schedule = TickSchedule(rollout.setup)
    ticks = [schedule.next() for _ in range(25 * TICKS_PER_STEP)]
    # It last sent at 9, which arrived at 9.5; the other one updates at every whole step.
    absent = [tick.absent[0].any() for tick in ticks if 0 in tick.updating]
    assert absent == [False] * 15 + [True] * 10


def test_the_answer_of_a_run_is_what_all_its_tiles_show() -> None:
    rollout = simulator(Conditions("clock"), runs=40)
    assert (rollout.answers() == -1).all(), "all are dark"
    trajectory = rollout.run(3)
    answers, shown = rollout.answers(), rollout.shown
    for run, (start, end) in enumerate(pairwise([*rollout.batch.starts, rollout.cells])):
        classes = set(shown[start:end].tolist())
        assert answers[run] == (classes.pop() if len(classes) == 1 else MIXED)
    targets = rollout.batch.target[rollout.batch.starts]
    assert ((answers == targets) == trajectory.agreed[-1]).all()
    assert set(answers.tolist()) > {MIXED, 0}, "runs of two minds and of one"


def test_only_counted_tiles_have_a_say_in_the_answer() -> None:
    for fault in FAULTS:
        rollout = simulator(Conditions("clock"), fault, runs=2)
        rollout.run(30)
        faulty = np.zeros(rollout.cells, np.bool_)
        faulty[faulty_cells(rollout)] = True
        assert (rollout.counted == (~faulty | (fault.kind == "away"))).all()


def faulty_cells(rollout: Simulator) -> NDArray[np.int64]:
    return rollout.setup.faulty[rollout.setup.faulty >= 0]


def rollout_with(fault: Fault, conditions: Conditions) -> tuple[Simulator, Trajectory]:
    rollout = simulator(conditions, fault)
    trajectory = rollout.run(30, record=True)
    assert trajectory.shown is not None
    return rollout, trajectory


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_a_tile_that_dies_is_dark_from_then_on_and_not_asked(schedule: Any) -> None:
    rollout, trajectory = rollout_with(Fault("dead", TILES, begin=12), Conditions(schedule))
    shown = trajectory.shown[:, faulty_cells(rollout)]  # type: ignore[index]
    assert (shown[11] >= 0).all()
    assert (shown[12:] == -1).all()
    others = np.ones(rollout.cells, np.bool_)
    others[faulty_cells(rollout)] = False
    good = (trajectory.shown == rollout.batch.target) & others
    expected = np.add.reduceat(good[-1], rollout.batch.starts) / np.add.reduceat(others, rollout.batch.starts)
    assert trajectory.right[-1] == pytest.approx(expected)


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_a_stuck_tile_keeps_its_state_and_display(schedule: Any) -> None:
    rollout = simulator(Conditions(schedule), Fault("stuck", TILES, begin=7))
    rollout.run(7)
    states, shown = rollout.states.copy(), rollout.shown.copy()
    rollout.run(20)
    stuck = faulty_cells(rollout)
    moved = (rollout.states != states).any(axis=1)
    assert not moved[stuck].any()
    assert np.array_equal(rollout.shown[stuck], shown[stuck])
    assert moved.sum() > len(stuck)


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_a_tile_that_was_away_is_dark_and_comes_back_as_the_seed(schedule: Any) -> None:
    rollout = simulator(Conditions(schedule), Fault("away", TILES, begin=6, end=18))
    trajectory = rollout.run(18, record=True)
    away = faulty_cells(rollout)
    assert (trajectory.shown[6:, away] == -1).all()  # type: ignore[index]
    assert (trajectory.right[6:, TILES >= 0] < 1).all(), "a dark tile is not right"
    later = rollout.run(12, record=True)
    assert (later.shown[-1, away] >= 0).all()  # type: ignore[index]


def test_states_of_another_shape_are_refused() -> None:
    with pytest.raises(ValueError, match="states"):
        Simulator(
            FastEngine(MODEL), LETTERS, np.array([1]), Conditions(), np.random.default_rng(1),
            np.zeros((3, 5), np.int16),
        )  # fmt: skip
