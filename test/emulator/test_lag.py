"""How far emulated tiles are behind the wall clock."""

import pytest

from support.terminal import stderr_on_terminal
from tilenca.emulator.lag import LIVE_S, MAX_LAG_S, TOLD_S, Lag, told


def test_tiles_live_as_long_as_the_clock_but_never_catch_up_more_than_a_tenth() -> None:
    lag = Lag()
    assert lag.take(0.01) == 0.01
    assert lag.behind_s == 0.0
    assert lag.take(2.1) == MAX_LAG_S
    assert [lag.wall_s, lag.behind_s] == pytest.approx([2.11, 2.0])
    assert lag.words() == "the tiles are 2.0 s behind real time: they lived 0.1 s of 2.1 s"


def test_a_little_is_not_worth_a_word() -> None:
    lag = Lag()
    while lag.behind_s < TOLD_S:
        assert lag.words() == ""
        lag.take(MAX_LAG_S + 0.0625)
    assert lag.words()


def test_at_the_end_it_is_told_once_with_a_remedy(capsys: pytest.CaptureFixture[str]) -> None:
    lag = Lag()
    with told(lag) as tell:
        lag.take(3.0)
        tell()
        assert capsys.readouterr().err == "", "there is no terminal"
    said = capsys.readouterr().err
    assert said.startswith("tilenca: the tiles are 2.9 s behind real time")
    assert said.endswith("a longer --period-ms, need less of this machine\n")
    assert said.count("\n") == 1


def test_tiles_that_kept_step_say_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    lag = Lag()
    with told(lag) as tell:
        for _ in range(300):
            lag.take(0.05)
            tell()
    assert capsys.readouterr() == ("", "")


def test_on_a_terminal_it_is_told_about_once_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    lag = Lag()
    with stderr_on_terminal(monkeypatch) as screen, told(lag) as tell:
        for _ in range(round(5 * LIVE_S / 0.25)):
            lag.take(0.25)
            tell()
    updates = screen.text.count("s behind real time")
    assert 4 <= updates <= 7, "five, and the one at the end"
