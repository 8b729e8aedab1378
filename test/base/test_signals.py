"""Ctrl-C at an awkward moment."""

import os
import signal

import pytest

from tilenca.base.signals import ending_like_ctrl_c, held_back


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_while_held_back_comes_after_the_block(number: signal.Signals) -> None:
    reached = []

    def interrupted() -> None:
        with held_back():
            os.kill(os.getpid(), number)
            reached.append("the end of the block")
        reached.append("what comes after it")

    with ending_like_ctrl_c():
        with pytest.raises(KeyboardInterrupt):
            interrupted()
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)
    assert reached == ["the end of the block"]


def test_a_block_without_an_interrupt_just_ends() -> None:
    before = signal.getsignal(signal.SIGINT)
    with held_back():
        pass
    assert signal.getsignal(signal.SIGINT) is before
