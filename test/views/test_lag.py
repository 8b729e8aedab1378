"""The lag of emulated tiles is shown while it grows, and once at the end."""

import pytest

from support.terminal import stderr_on_terminal
from tilenca.emulator.lag import Lag
from tilenca.views.lag import LIVE_S, show_lag


def test_at_the_end_it_is_told_once_with_a_remedy(capsys: pytest.CaptureFixture[str]) -> None:
    lag = Lag()
    with show_lag(lag) as tell:
        lag.take(3.0)
        tell()
        assert capsys.readouterr().err == "", "there is no terminal"
    said = capsys.readouterr().err
    assert said.startswith("tilenca: the tiles are 2.9 s behind real time")
    assert said.endswith("a longer --period-ms, need less of this machine\n")
    assert said.count("\n") == 1


def test_tiles_that_kept_step_say_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    lag = Lag()
    with show_lag(lag) as tell:
        for _ in range(300):
            lag.take(0.05)
            tell()
    assert capsys.readouterr() == ("", "")


def test_on_a_terminal_it_is_told_about_once_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    lag = Lag()
    with stderr_on_terminal(monkeypatch) as screen, show_lag(lag) as tell:
        for _ in range(round(5 * LIVE_S / 0.25)):
            lag.take(0.25)
            tell()
    updates = screen.text.count("s behind real time")
    assert 4 <= updates <= 7, "five, and the one at the end"
