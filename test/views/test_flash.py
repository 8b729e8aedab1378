"""What a person sees while boards are programmed."""

import re

import pytest

from support.terminal import stderr_on_terminal
from tilenca.fleet.avrdude import Progress
from tilenca.views.flash import display, ending


def test_on_a_narrow_terminal_boards_are_told_apart_by_the_end_of_their_names() -> None:
    titles = [f"/tmp/a-long-folder-name-of-a-port/tile-{number} tile {number}" for number in (1, 2)]
    shown = [ending(title, 20) for title in titles]
    assert [line[-14:] for line in shown] == ["/tile-1 tile 1", "/tile-2 tile 2"]
    assert {len(line) for line in shown} == {20}
    assert ending("ttyACM3", 0) == "ttyACM3"


TITLES = {"/dev/ttyACM0": "ttyACM0 [tile 1]", "/dev/ttyACM1": "ttyACM1 [tile 2]"}


def flash_two() -> None:
    with display(TITLES) as shown:
        shown.show("/dev/ttyACM0", Progress("writing", 0.5))
        shown.show("/dev/ttyACM0", Progress("writing", 0.6))
        shown.show("/dev/ttyACM0", Progress("verifying", 1.0))
        shown.done("/dev/ttyACM0", "flashed", None)
        shown.done("/dev/ttyACM1", "failed", "no reply; is it a tile?")


def test_without_a_terminal_every_change_of_a_phase_is_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    flash_two()
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == [
        "ttyACM0 [tile 1]: writing",
        "ttyACM0 [tile 1]: verifying",
        "ttyACM0 [tile 1]: flashed (1 of 2 done)",
        "ttyACM1 [tile 2]: failed: no reply; is it a tile? (2 of 2 done)",
    ]


@pytest.mark.parametrize("width", [60, 120])
def test_on_a_terminal_each_board_has_a_bar_and_all_have_one(
    width: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with stderr_on_terminal(monkeypatch, width=width) as screen:
        flash_two()
    lines = [line.strip() for line in re.split(r"[\r\n]+", screen.text) if line.strip()]
    first, second, total = lines[-3:]
    assert re.match(r"ttyACM0 \[tile 1\] ━+ flashed", first)
    assert re.match(r"ttyACM1 \[tile 2\] ━+ failed", second)
    assert re.match(r"all +━+╺?━* 2 of 2 done", total)
    assert all(len(line) <= width for line in lines)
    assert ("0:00:0" in total) == (width > 100), "the time has no room on a narrow one"


def test_a_single_board_needs_no_total(monkeypatch: pytest.MonkeyPatch) -> None:
    with stderr_on_terminal(monkeypatch) as screen, display({"/dev/ttyACM0": "ttyACM0"}) as shown:
        shown.done("/dev/ttyACM0", "flashed", None)
    assert "flashed" in screen.text
    assert "all" not in screen.text
