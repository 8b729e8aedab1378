"""Ctrl-C at an awkward moment."""

import os
import signal

import pytest

from tilenca.base.signals import ending_like_ctrl_c, held_back
from tilenca.cli import main
from tilenca.commands import devices


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


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_polite_ends_are_one_and_handlers_are_restored(
    number: signal.Signals, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = signal.getsignal(number)
    monkeypatch.setattr(devices, "run", lambda _: signal.raise_signal(number))
    assert main(["devices"]) == 130
    assert capsys.readouterr().err == "tilenca: interrupted\n"
    assert signal.getsignal(number) is before


def test_what_nohup_ignores_stays_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang_up(_: object) -> int:
        signal.raise_signal(signal.SIGHUP)
        return 0

    monkeypatch.setattr(devices, "run", hang_up)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert main(["devices"]) == 0
    finally:
        signal.signal(signal.SIGHUP, before)
