"""Stepping back in time."""

import pytest

from support.avr import Compile
from support.busy_tiles import BUSY, build
from tilenca.base.errors import UsageError
from tilenca.emulator.history import History


def test_stepping_back_in_time(avr: Compile) -> None:
    array = build(avr(BUSY))
    history = History(array, every_s=0.01)
    history.run(0.1)
    end = array.save()
    history.go_to(0.0432)
    assert array.time_s == pytest.approx(0.0432, abs=16e-6)
    history.go_to(0.0999)
    history.run(0.0001)
    assert array.time_s == pytest.approx(0.1, abs=32e-6)
    history.go_to(0.0)
    assert [tile.cycles[0] for tile in array] == [0, 0, 0]
    array.run(0.1)
    assert array.save() == end


def test_a_history_keeps_no_more_than_it_was_told(avr: Compile) -> None:
    array = build(avr(BUSY))
    history = History(array, every_s=0.001, most=10)
    history.run(0.1)
    assert len(history.moments_s) == 10
    with pytest.raises(UsageError, match=r"the oldest moment kept is 0\.09"):
        history.go_to(0.05)
