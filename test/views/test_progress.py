"""How far slow work is: bars on a terminal, nothing elsewhere."""

import re

import pytest
from rich.console import Console

from support.terminal import stderr_on_terminal
from tilenca.views.progress import show_bars, show_progress


def test_each_piece_has_a_bar_with_its_note(monkeypatch: pytest.MonkeyPatch) -> None:
    with stderr_on_terminal(monkeypatch) as screen, show_progress() as tell:
        tell("4", 0.0, "laying out")
        tell("8", 0.5, "30 of 60 steps")
        tell("4", 1.0, "60 of 60 steps")
    assert re.search(r"4 ━+ 60 of 60 steps 0:00:0\d", screen.text)
    assert re.search(r"8 ━+╺?━* 30 of 60 steps 0:00:0\d", screen.text)


def test_a_piece_may_begin_anew_under_the_same_name(monkeypatch: pytest.MonkeyPatch) -> None:
    with stderr_on_terminal(monkeypatch) as screen, show_progress() as tell:
        for share in (0.5, 1.0, 0.5, 1.0):
            tell("4", share, f"at {share}")
    assert screen.text.count("at 1.0") >= 2


def test_names_and_notes_are_no_markup(monkeypatch: pytest.MonkeyPatch) -> None:
    with stderr_on_terminal(monkeypatch) as screen, show_progress() as tell:
        tell("[red]4", 1.0, "tiles[0] [/]")
    assert "[red]4" in screen.text
    assert "tiles[0] [/]" in screen.text


def test_without_a_terminal_nothing_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    with show_progress() as tell:
        tell("4", 0.5, "half")
        tell("4", 1.0, "whole")
    assert capsys.readouterr() == ("", "")


def test_time_counts_from_the_first_move_and_has_room_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    with stderr_on_terminal(monkeypatch) as screen, show_bars(Console(stderr=True)) as bars:
        bars.add("a", "tile 1", note="waiting", begun=False)
    assert re.search(r"tile 1 ━+ waiting -:--:--", screen.text)
    with stderr_on_terminal(monkeypatch) as screen, show_bars(Console(stderr=True), 8, time=None) as bars:
        bars.add("a", "tile 1", note="waiting")
        bars.move("a", 0.5, "writing")
    assert re.search(r"tile 1 ━━━━━━━━ waiting *\r?\n|tile 1 ━+╺?━* writing *\r?\n", screen.text)
    assert ":" not in screen.text
