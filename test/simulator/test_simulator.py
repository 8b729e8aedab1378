"""The compiled simulator: to the bit what a slow one in plain Python does, whatever goes wrong."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from support.reference_network import reference
from support.reference_simulator import SlowRun
from support.restless_grids import CONDITIONS, FAULTS, LETTERS, MODEL, TILES, PlainEngine, same, simulator
from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import Shape
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Conditions, Fault, Simulator, Trajectory

CLASSES = 3


def block(rows: int, cols: int) -> Drawings:
    """One drawing full of tiles."""
    shape = Shape("0", ("#" * cols,) * rows, "0")
    return Drawings((shape,), (0,), ("0", "1", "2"), ({"file": "block.toml", "sha256": ""},))


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
    [
        Conditions(schedule, loss=0.3, lost=lost)
        for schedule in ("random", "clock")
        for lost in ("held", "zero")
    ]
    + [Conditions("clock", dead=0.2), Conditions("random", dead=0.2)],
    ids=str,
)
def test_with_a_fault_too_it_is_the_slow_simulator(fault: Fault, conditions: Conditions) -> None:
    if conditions.dead and fault.kind == "dead":
        conditions = replace(conditions, dead=0.0)  # or nobody would be left to ask in a run of three tiles
    check_against_the_slow_one(simulator(conditions, fault, seed=12), 24)


@pytest.mark.parametrize("schedule", ["random", "clock"])
def test_a_run_of_more_tiles_than_a_number_has_bits_is_the_slow_simulator_too(schedule: Any) -> None:
    check_against_the_slow_one(simulator(Conditions(schedule, loss=0.1), runs=1, drawings=block(9, 15)), 4)


@pytest.mark.parametrize("schedule", ["random", "clock"])
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
    for schedule in ("random", "clock"):
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


def faulty_cells(rollout: Simulator) -> NDArray[np.int64]:
    return rollout.setup.faulty[rollout.setup.faulty >= 0]


def rollout_with(fault: Fault, conditions: Conditions) -> tuple[Simulator, Trajectory]:
    rollout = simulator(conditions, fault)
    trajectory = rollout.run(30, record=True)
    assert trajectory.shown is not None
    return rollout, trajectory


@pytest.mark.parametrize("schedule", ["random", "clock"])
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


@pytest.mark.parametrize("schedule", ["random", "clock"])
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


@pytest.mark.parametrize("schedule", ["random", "clock"])
def test_a_tile_that_was_away_is_dark_and_comes_back_as_the_seed(schedule: Any) -> None:
    rollout = simulator(Conditions(schedule), Fault("away", TILES, begin=6, end=18))
    trajectory = rollout.run(18, record=True)
    away = faulty_cells(rollout)
    assert (trajectory.shown[6:, away] == -1).all()  # type: ignore[index]
    assert (trajectory.right[6:, TILES >= 0] < 1).all(), "a dark tile is not right"
    later = rollout.run(12, record=True)
    assert (later.shown[-1, away] >= 0).all()  # type: ignore[index]


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"loss": 1.5}, "shares"),
        ({"dead": -0.1}, "shares"),
        ({"schedule": "often"}, "no such schedule"),
        ({"lost": "found"}, "no such schedule"),
        ({"latency": (0.0, 0.5)}, "arrives before"),
        ({"latency": (0.5, 0.4)}, "arrives before"),
        ({"drift": 0.2}, "arrives before"),
        ({"drift": -0.1}, "arrives before"),
        ({"boot": -1.0}, "arrives before"),
        ({"boot": float("nan")}, "arrives before"),
    ],
)
def test_conditions_that_make_no_sense_are_refused(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Conditions(**settings)


@pytest.mark.parametrize(
    "settings",
    [
        {"kind": "tired"},
        {"kind": "dead", "begin": -1},
        {"kind": "dead", "end": 4},
        {"kind": "away"},
        {"kind": "away", "begin": 4, "end": 4},
    ],
)
def test_faults_that_make_no_sense_are_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="fault"):
        Fault(tiles=TILES, **settings)


@pytest.mark.parametrize("tiles", [[0, 0], [0, 3, 0, 0, 0, 0], [0, -2, 0, 0, 0, 0], [8, 0, 0, 0, 0, 0]])
def test_a_fault_of_tiles_that_are_not_there_is_refused(tiles: list[int]) -> None:
    with pytest.raises(ValueError, match="6 runs need as many tiles"):
        simulator(Conditions(), Fault("dead", np.array(tiles)))


def test_a_run_without_a_tile_that_counts_is_refused() -> None:
    with pytest.raises(ValueError, match="none is left to count"):
        simulator(Conditions(), Fault("stuck", np.zeros(1, np.int64)), runs=1, drawings=block(1, 1))


def test_states_of_another_shape_are_refused() -> None:
    with pytest.raises(ValueError, match="states"):
        Simulator(
            FastEngine(MODEL), LETTERS, np.array([1]), Conditions(), np.random.default_rng(1),
            np.zeros((3, 5), np.int16),
        )  # fmt: skip
