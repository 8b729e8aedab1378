"""How far emulated tiles are behind the wall clock."""

import pytest

from tilenca.emulator.lag import MAX_LAG_S, TOLD_S, Lag


def test_tiles_run_as_long_as_the_clock_but_never_catch_up_more_than_a_tenth() -> None:
    lag = Lag()
    assert lag.take(0.01) == 0.01
    assert lag.behind_s == 0.0
    assert lag.take(2.1) == MAX_LAG_S
    assert [lag.wall_s, lag.behind_s] == pytest.approx([2.11, 2.0])
    assert lag.words() == "the tiles are 2.0 s behind real time: they ran 0.1 s of 2.1 s"


def test_a_little_is_not_worth_a_word() -> None:
    lag = Lag()
    while lag.behind_s < TOLD_S:
        assert lag.words() == ""
        lag.take(MAX_LAG_S + 0.0625)
    assert lag.words()
