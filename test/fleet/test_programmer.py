"""Many boards at once, each by an avrdude of its own; test_flash.py tries all that can go wrong with one."""

from contextlib import ExitStack
from pathlib import Path

import pytest

from support.bootloader_stand_in import ATMEGA_328P, StandIn
from support.intel_hex import image
from tilenca.fleet.avrdude import Progress, find_avrdude
from tilenca.fleet.programmer import ProgramResult, program_all

DATA = bytes(index * 5 & 0xFF for index in range(2000))


@pytest.fixture
def firmware(tmp_path: Path) -> Path:
    path = tmp_path / "firmware.hex"
    path.write_text(image(DATA))
    return path


def test_outcomes_come_in_the_order_asked_and_each_is_reported_once(firmware: Path) -> None:
    outcomes: list[str] = []
    phases: dict[str, list[str]] = {}

    def report(name: str, news: Progress | ProgramResult) -> None:
        if isinstance(news, ProgramResult):
            outcomes.append(name)
        else:
            phases.setdefault(name, []).append(news.phase)

    with ExitStack() as stack:
        boards = [stack.enter_context(StandIn()) for _ in range(3)]
        boards.insert(1, stack.enter_context(StandIn(signature=ATMEGA_328P)))
        names = [board.port for board in boards]
        results = program_all(find_avrdude(), firmware, names, 2, 20.0, report)
    assert [one.port for one in results] == names
    assert [one.result for one in results] == ["flashed", "failed", "flashed", "flashed"]
    assert [one.attempts for one in results] == [1, 1, 1, 1], "a wrong chip stays one"
    assert sorted(outcomes) == sorted(names)
    for board in (boards[0], *boards[2:]):
        assert board.flash[: len(DATA)] == DATA
        assert list(dict.fromkeys(phases[board.port])) == ["connecting", "writing", "verifying"]


def test_an_interrupt_names_those_that_are_not_done(firmware: Path) -> None:
    with StandIn() as first, StandIn() as second:

        def report(name: str, news: Progress | ProgramResult) -> None:
            if isinstance(news, ProgramResult):
                raise KeyboardInterrupt

        names = [first.port, second.port]
        results = program_all(find_avrdude(), firmware, names, 1, 20.0, report)
    assert [one.result for one in results] == ["flashed", "interrupted"]
    assert results[1].error == "interrupted; flash it again"


def test_no_board_is_no_work(firmware: Path) -> None:
    assert program_all(find_avrdude(), firmware, [], 4, 20.0, lambda name, news: None) == []
