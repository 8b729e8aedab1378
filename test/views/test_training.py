"""How training looks, on a terminal and elsewhere."""

import re

import pytest

from support.standing_clock import StandingClock
from support.terminal import stderr_on_terminal
from tilenca.training.progress import Progress
from tilenca.views import training
from tilenca.views.training import LINE_EVERY_S, show_measuring, show_training


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> StandingClock:
    """The clock that the view goes by."""
    owned = StandingClock()
    monkeypatch.setattr(training, "time", owned)
    return owned


def test_on_a_terminal_every_seed_has_a_bar_with_its_loss_and_targets(
    clock: StandingClock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with stderr_on_terminal(monkeypatch, width=140) as screen, show_training([5, 6], 400) as tell:
        tell(Progress(5, 100, 0.25, 0.5, None))
        clock.seconds += 2.0
        tell(Progress(5, 200, 0.125, 0.75, (3, 8, 0.0625)))
    lines = [line for line in re.split(r"[\r\n]+", screen.text) if "seed" in line]
    last = {line.split()[1]: line for line in lines}
    assert last.keys() == {"5", "6"}
    assert "200/400" in last["5"]
    assert "loss 0.1250  all right 75.0%  50/s" in last["5"]
    assert "  on the way 3 of 8 targets met, 0.062 short" in last["5"]
    assert "0/400" in last["6"]
    assert "loss" not in last["6"], "it has not begun"
    assert not any("seed 5:" in line for line in lines), "a plain line among the bars"
    assert capsys.readouterr().out == ""


def test_the_time_left_is_by_the_rate_of_this_run_not_of_the_one_it_goes_on_from(
    clock: StandingClock, capsys: pytest.CaptureFixture[str]
) -> None:
    with show_training([5], 2000) as tell:
        tell(Progress(5, 1400, 1.0, 0.0, None))
        clock.seconds += LINE_EVERY_S
        tell(Progress(5, 1500, 1.0, 0.9, None))
        clock.seconds += LINE_EVERY_S
        tell(Progress(5, 1950, 1.0, 0.95, (11, 14, 0.1)))
    first, *lines = capsys.readouterr().err.splitlines()
    assert first == "seed 5: 1400 of 2000 iterations; all tiles right on 0% of the drawings"
    assert lines == [
        "seed 5: 1500 of 2000 iterations; all tiles right on 90% of the drawings; about 5 min left",
        "seed 5: 1950 of 2000 iterations; all tiles right on 95% of the drawings; on the way 11 of 14 "
        "targets met; less than a minute left, less if the targets hold early",
    ]


def test_without_a_terminal_each_seed_tells_a_line_a_minute_and_its_end(
    clock: StandingClock, capsys: pytest.CaptureFixture[str]
) -> None:
    with show_training([5, 6], 1000) as tell:
        for iteration in range(1, 1001):
            tell(Progress(5, iteration, 0.5, 0.25, None))
            clock.seconds += LINE_EVERY_S / 400
        tell(Progress(6, 1000, 0.5, 0.25, (8, 8, 0.0)))
    said = capsys.readouterr()
    assert said.out == ""
    told = [line.split()[1:3] for line in said.err.splitlines()]
    assert told == [["5:", "1"], ["5:", "401"], ["5:", "801"], ["5:", "1000"], ["6:", "1000"]]
    assert said.err.endswith("; on the way 8 of 8 targets met\n")


def test_a_measurement_tells_where_its_rows_will_be_and_how_many_there_are(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with show_measuring("mine/README.md", 30) as tell:
        for row in range(25):
            tell(f"row {row}")
    first, *lines = capsys.readouterr().err.splitlines()
    assert first.endswith("every row will be in mine/README.md")
    assert lines == ["10 of 30 rows measured", "20 of 30 rows measured"]
    with stderr_on_terminal(monkeypatch, width=140) as screen, show_measuring("mine/README.md", 30) as tell:
        tell("5x4: 0.998")
        assert not capsys.readouterr().out
    assert "mine/README.md" in screen.text
    assert "1 of 30 rows measured; 5x4: 0.998" in screen.text
