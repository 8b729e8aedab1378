"""Steps of the set-up run side by side, tell that they do, and end together where one fails."""

import re
import sys
import threading
from collections.abc import Callable

import pytest

from setup import command
from setup.command import SetupError, StoppedError, run
from setup.side_by_side import Awaited, side_by_side

LIMIT_S = 60.0


@pytest.fixture(autouse=True)
def programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a test stops is not what the next one starts."""
    monkeypatch.setattr(command, "_programs", command._Programs())


def hanging(started: threading.Event) -> Callable[[], None]:
    """A step that must be stopped: the program that its program starts takes a minute."""
    inner = f"import time; time.sleep({LIMIT_S})"
    program = f"import subprocess, sys; subprocess.run([sys.executable, '-c', '{inner}'], check=True)"

    def step() -> None:
        started.set()
        with pytest.raises(StoppedError):
            run([sys.executable, "-c", program], "it failed by itself")

    return step


def test_lanes_run_at_the_same_time() -> None:
    both = threading.Barrier(2)
    side_by_side({name: lambda: void(both.wait(LIMIT_S)) for name in ("one", "other")})
    assert not both.broken


def void(_: object) -> None:
    """A lane returns nothing."""


def test_a_failure_stops_what_the_others_run_and_is_the_one_that_is_told(
    capfd: pytest.CaptureFixture[str],
) -> None:
    started, awaited, went_on = threading.Event(), Awaited(), []

    def failing() -> None:
        with awaited:
            assert started.wait(LIMIT_S)
            run([sys.executable, "-c", "print('why it failed'); raise SystemExit(3)"], "do this instead")

    def waiting() -> None:
        awaited.wait()
        went_on.append("it")

    def next_step() -> None:
        hanging(started)()
        run([sys.executable, "-c", "print('started after all')"], "")

    with pytest.raises(SetupError, match=r"^do this instead \(exit status 3\)$") as caught:
        side_by_side({"waiting": waiting, "hanging": next_step, "failing": failing})
    assert not isinstance(caught.value, StoppedError)
    assert went_on == []
    assert capfd.readouterr().err == "why it failed\n"


def test_a_lane_may_wait_for_the_work_of_another() -> None:
    awaited, order = Awaited(), []

    def first() -> None:
        with awaited:
            order.append("first")

    def second() -> None:
        awaited.wait()
        order.append("second")

    side_by_side({"second": second, "first": first})
    assert order == ["first", "second"]


def test_ctrl_c_ends_the_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    started, ended = threading.Event(), threading.Event()

    def step() -> None:
        hanging(started)()
        ended.set()

    def interrupted(*_: object) -> None:
        assert started.wait(LIMIT_S)
        raise KeyboardInterrupt

    monkeypatch.setattr("setup.side_by_side.wait", interrupted)
    with pytest.raises(KeyboardInterrupt):
        side_by_side({"hanging": step})
    assert ended.is_set()


def test_what_takes_long_is_told_now_and_then_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    told = threading.Event()
    say = command.say

    def heard(message: str) -> None:
        say(message)
        told.set()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("setup.side_by_side.say", heard)
        lanes = dict.fromkeys(("Python packages", "the C++ libraries"), lambda: void(told.wait(LIMIT_S)))
        side_by_side(lanes, still_s=0.01)
    first = capsys.readouterr().err.splitlines()[0]
    assert re.fullmatch(
        r"setup: still busy with Python packages and the C\+\+ libraries \(0 s; 0 of \d parts done\)", first
    )
