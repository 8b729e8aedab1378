"""Ctrl-C at an awkward moment."""

import os
import queue
import signal
import threading

import pytest

from tilenca.base.signals import acknowledging, ending_like_ctrl_c, held_back, promising
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


def test_an_interrupt_is_acknowledged_while_compiled_code_runs() -> None:
    said: queue.SimpleQueue[str] = queue.SimpleQueue()
    before = signal.signal(signal.SIGTERM, lambda number, frame: None)
    try:
        with acknowledging(said.put, after_s=0), promising("saves the work first"):
            signal.raise_signal(signal.SIGTERM)
            assert said.get(timeout=30) == "tilenca: SIGTERM: saves the work first"
        with acknowledging(said.put, after_s=0):
            signal.raise_signal(signal.SIGTERM)
            assert said.get(timeout=30) == "tilenca: SIGTERM: ends as soon as the step at work is done"
    finally:
        signal.signal(signal.SIGTERM, before)


def test_a_second_ctrl_c_is_told_what_it_changes_and_other_signals_repeat_the_promise() -> None:
    said: queue.SimpleQueue[str] = queue.SimpleQueue()
    before = {number: signal.signal(number, lambda *_: None) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with acknowledging(said.put, after_s=0), promising("saves first; again ends without", "ends without"):
            for number, text in (
                (signal.SIGTERM, "SIGTERM: saves first; again ends without"),
                (signal.SIGINT, "Ctrl-C: saves first; again ends without"),
                (signal.SIGTERM, "SIGTERM: saves first; again ends without"),
                (signal.SIGINT, "Ctrl-C: ends without"),
            ):
                signal.raise_signal(number)
                assert said.get(timeout=30) == f"tilenca: {text}"
        for _ in range(2):  # a new command begins anew
            with acknowledging(said.put, after_s=0):
                signal.raise_signal(signal.SIGINT)
                assert said.get(timeout=30) == "tilenca: Ctrl-C: ends as soon as the step at work is done"
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def test_a_command_that_ends_at_once_needs_no_acknowledgement() -> None:
    said: list[str] = []
    with pytest.raises(KeyboardInterrupt), ending_like_ctrl_c(), acknowledging(said.append, after_s=30):
        signal.raise_signal(signal.SIGHUP)
    assert said == []


def test_other_threads_and_other_signals_are_left_alone() -> None:
    said: list[str] = []
    before = signal.signal(signal.SIGUSR1, lambda number, frame: None)
    try:
        with acknowledging(said.append, after_s=0):
            signal.raise_signal(signal.SIGUSR1)
            in_thread = threading.Thread(target=lambda: acknowledging(said.append).__enter__())
            in_thread.start()
            in_thread.join()
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert said == []
    assert signal.set_wakeup_fd(-1) == -1
