"""Pace: how much emulated time passes, by a clock that the test owns."""

import pytest

from tilenca.page.pace import SLICE_WALL_S, Pace

TICK_S = 1 / 60


def play(pace: Pace, wall_s: float, rate: float, now_s: float = 0.0) -> float:
    """The emulated time after `wall_s`, by an emulation that does `rate` times real time, in whole 16 us."""
    for _ in range(round(wall_s / TICK_S)):
        run_s = pace.take(TICK_S, now_s)
        ran_s = round(run_s / 16e-6) * 16e-6
        now_s += ran_s
        if run_s:
            pace.ran(ran_s, ran_s / rate, now_s)
    return now_s


@pytest.mark.parametrize("speed", [1e-4, 0.001, 0.1, 1.0, 2.0])
def test_time_passes_at_the_speed_asked_for(speed: float) -> None:
    pace = Pace(speed)
    assert play(pace, 10, rate=5) == pytest.approx(10 * speed, rel=0.01, abs=17e-6)
    assert pace.share == pytest.approx(1, abs=0.01)


def test_an_emulation_that_is_too_slow_says_what_share_it_reaches_and_does_not_catch_up() -> None:
    pace = Pace(1.0)
    assert play(pace, 10, rate=0.25) == pytest.approx(2.5, rel=0.1)
    assert pace.share == pytest.approx(0.25, rel=0.1)


def test_full_speed_fills_each_slice_and_no_more() -> None:
    pace = Pace(0.0)
    assert play(pace, 10, rate=7) == pytest.approx(70, rel=0.1)
    assert pace.take(TICK_S, 70) / 7 == pytest.approx(SLICE_WALL_S, rel=0.1)


def test_a_pause_is_no_time() -> None:
    pace = Pace(1.0, paused=True)
    assert play(pace, 1, rate=5) == 0
    pace.set(1.0, paused=False)
    assert play(pace, 1, rate=5) == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize("speed", [0.0, 0.3, 1.0])
def test_it_pauses_at_the_moment_asked_for_and_goes_on_from_there(speed: float) -> None:
    pace = Pace(speed, until_s=0.5)
    assert play(pace, 5, rate=5) == pytest.approx(0.5, abs=1e-9)
    assert pace.paused
    pace.set(1.0, paused=False)
    assert play(pace, 1, rate=5, now_s=0.5) == pytest.approx(1.5, abs=0.02)
