"""What chance decides about runs before they begin."""

import numpy as np
import pytest

from support.restless_grids import LETTERS, block, simulator
from tilenca.model.file import Dimensions
from tilenca.shapes.batch import Batch
from tilenca.simulator.chance import draw_setup
from tilenca.simulator.conditions import Conditions, Fault, Rebuilding
from tilenca.simulator.rollout_library import Setup
from tilenca.simulator.tile_times import HALF_TICK, tile_times

RUNS = 300


def batch() -> Batch:
    return LETTERS.batch(np.tile(np.arange(len(LETTERS)), RUNS))


def drawn(conditions: Conditions, running: bool = False) -> Setup:
    return draw_setup(batch(), conditions, np.random.default_rng(1), running, None)


def test_tiles_are_switched_on_one_period_before_their_first_update_and_the_last_one_at_step_0() -> None:
    setup = drawn(Conditions("clock", boot=4.0, drift=0.02))
    assert setup.clocks is not None
    first, period, latency = setup.clocks.first, setup.clocks.period, setup.clocks.latency
    on = first - period
    assert setup.clocks.start == -4.0
    assert on.min() > -4.0
    assert np.maximum.reduceat(on, setup.starts[:-1]) == pytest.approx(0.0)
    assert 0.98 <= period.min() < 0.985 < 1.015 < period.max() <= 1.02
    assert 0.1 <= latency.min() < 0.12 < 0.88 < latency.max() <= 0.9
    assert not setup.running


def test_tiles_that_run_already_have_any_phase() -> None:
    setup = drawn(Conditions("clock"), running=True)
    assert setup.clocks is not None
    first, period = setup.clocks.first, setup.clocks.period
    assert setup.clocks.start == 0.0
    assert np.histogram(first / period, bins=4, range=(0, 1))[0] == pytest.approx(len(first) / 4, rel=0.1)
    assert setup.running


def test_the_times_of_tiles_are_those_of_their_sides_and_of_as_many_neighbours_as_they_have() -> None:
    times = tile_times(Dimensions(24, 96, 96), 20)
    setup = drawn(Conditions("clock", latency=times, boot=4.0))
    assert setup.clocks is not None
    assert setup.clocks.start == -5.0
    on = setup.clocks.first - setup.clocks.period
    assert np.maximum.reduceat(on, setup.starts[:-1]) == pytest.approx(-times.ends)
    assert setup.clocks.latency.shape == (len(on), 4)
    neighbours = (setup.neighbours < len(on)).sum(axis=1)
    most = setup.clocks.period[:, None]
    expected = np.array(times.computing)[neighbours][:, None] + times.sending + HALF_TICK
    assert setup.clocks.latency == pytest.approx(np.minimum(expected, most), abs=1e-5)
    assert (setup.clocks.latency < most).all()


def test_a_schedule_without_clocks_draws_none() -> None:
    assert drawn(Conditions("random")).clocks is None
    assert drawn(Conditions("listing")).clocks is None


def test_as_many_tiles_are_dead_as_were_asked_for_but_never_all_of_a_run() -> None:
    assert drawn(Conditions(dead=0.3)).alive.mean() == pytest.approx(0.7, abs=0.03)
    everyone = drawn(Conditions(dead=1.0))
    assert (np.add.reduceat(everyone.alive, everyone.starts[:-1], dtype=int) == 1).all()


def test_tiles_that_are_put_down_later_are_not_there_at_the_start() -> None:
    cells = batch()
    present = cells.place > 0
    switches = np.array([[3, 0, 1]], np.int32)
    setup = draw_setup(cells, Conditions(), np.random.default_rng(1), False, Rebuilding(present, switches))
    assert (setup.alive == present).all()
    assert setup.changes is switches


@pytest.mark.parametrize("tiles", [[0, 0], [0, 3, 0, 0, 0, 0], [0, -2, 0, 0, 0, 0], [8, 0, 0, 0, 0, 0]])
def test_a_fault_of_tiles_that_are_not_there_is_refused(tiles: list[int]) -> None:
    with pytest.raises(ValueError, match="6 runs need as many tiles"):
        simulator(Conditions(), Fault("dead", np.array(tiles)))


def test_a_run_without_a_tile_that_counts_is_refused() -> None:
    with pytest.raises(ValueError, match="none is left to count"):
        simulator(Conditions(), Fault("stuck", np.zeros(1, np.int64)), runs=1, drawings=block(1, 1))
