"""Asking and telling many tiles at once: each gives an answer, or a reason why there is none."""

import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from support.scripted_port import HELLO, Device
from tilenca.fleet.identify import SILENT, ask_all
from tilenca.fleet.lock import port_lock
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.commands import ask_command, chip_command
from tilenca.protocol.sentences import (
    BoardSentence,
    ChipSentence,
    LinkSentence,
    Sentence,
    TileSentence,
    format_sentence,
    framed,
)

STATE = format_sentence(TileSentence(7, 100, 1, "4", 4, 30, "----", bytes([128] * 21)))


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_each_port_has_its_answer_or_a_reason_in_the_order_asked(stack: ExitStack) -> None:
    greets = stack.enter_context(Device(format_sentence(HELLO)))
    older = stack.enter_context(Device(framed("HELLO,1,7,BEEF,21,10,250,0,04")))
    silent, taken = stack.enter_context(Device()), stack.enter_context(Device())
    stack.enter_context(port_lock(taken.port, "screen"))
    names = [silent.port, "/dev/no-such-port", taken.port, older.port, greets.port]
    reported: list[str] = []
    answers = ask_all(names, "a test", lambda name, answer: reported.append(name), patience_s=2.0)
    assert list(answers) == names
    assert answers[greets.port].firmware_id == 0xABCDEF01
    assert [answers[name].problem for name in names[:2]] == [SILENT, "no such port"]
    assert answers[taken.port].problem.startswith("busy: screen (pid ")
    assert answers[older.port].problem == "speaks protocol 1"
    assert sorted(reported) == sorted(names)
    assert not silent.heard, "a bootloader may be listening: it is not spoken to"


def test_a_tile_that_speaks_is_asked_and_one_that_greets_is_not(stack: ExitStack) -> None:
    said_when_asked: list[int] = []

    def answer(line: bytes, count: int) -> bytes:
        said_when_asked.append(asked.said)
        return format_sentence(HELLO)

    asked = stack.enter_context(Device(STATE, answer))
    began_s = time.monotonic()

    def clock() -> float:
        """Stands still until the tile has spoken three times."""
        return time.monotonic() - began_s if asked.said >= 3 else 0.0

    answers = ask_all([asked.port], "a test", clock=clock)
    assert answers[asked.port].hello == HELLO
    assert asked.heard[0] == ask_command()
    assert said_when_asked[0] >= 3, "what was said before a reset proves nothing"


def test_what_a_tile_measures_is_awaited_where_it_is_wanted(stack: ExitStack) -> None:
    first = BoardSentence(7, 500, 4380, (0,) * 4, (0,) * 4)
    board = BoardSentence(7, 1500, 4380, (0, 9, 0, 0), (0,) * 4)
    links = [LinkSentence(7, at, "E", 0, at, 0, at, 0, 20, 0, 1, "W") for at in (100, 500)]
    chip = ChipSentence(7, 0xFF, 0xD8, 0xFD, 0xCF)
    said: list[Sentence] = [chip, *links, first, board]

    def answer(line: bytes, count: int) -> bytes:
        assert line == chip_command()
        return b"".join(format_sentence(one) for one in said)

    new = stack.enter_context(Device(format_sentence(HELLO), answer))
    old = stack.enter_context(Device(format_sentence(HELLO)))
    answers = ask_all([new.port, old.port], "a test", board_s=1.0)
    assert [answers[port].board for port in (new.port, old.port)] == [board, None]
    assert answers[new.port].board_before == first
    assert {side: health.good for side, health in answers[new.port].health.items()} == {"E": 0.5}
    assert [answers[port].chip for port in (new.port, old.port)] == [chip, None]
    assert answers[old.port].hello == HELLO, "an older firmware says no such thing"


def test_a_board_under_test_is_told_from_one_that_is_silent(stack: ExitStack) -> None:
    tested = stack.enter_context(Device(b"display: only segment a PH4\r\n"))
    assert ask_all([tested.port], "a test")[tested.port].problem == BOARD_TEST
    assert not tested.heard, "letters are commands to it"
