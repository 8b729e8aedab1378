"""What the firmware measures on its board, on each side: supply, framing errors, low lines."""

from pathlib import Path

import pytest

from support.line_faults import AHEAD_S, CLOCK_HZ
from tilenca.base.sides import SIDES
from tilenca.emulator import Array, EmulatedTile
from tilenca.protocol.commands import chip_command, mark_command
from tilenca.protocol.constants import LEAST_SUPPLY_MV, MARKING_AT, SETTINGS_SIZE
from tilenca.protocol.sentences import (
    AckSentence,
    BoardSentence,
    ChipSentence,
    ErrorSentence,
    NakSentence,
    Sentence,
    parse_sentence,
)
from tilenca.protocol.settings import marking_block, settings_block


def said(tile: EmulatedTile) -> list[Sentence | None]:
    return [parse_sentence(line) for line in tile.read_serial().splitlines()]


def last_board(tile: EmulatedTile) -> BoardSentence:
    return [one for one in said(tile) if isinstance(one, BoardSentence)][-1]


@pytest.mark.parametrize("side", range(4), ids=list(SIDES))
def test_breaks_and_low_lines_are_counted_on_their_side_only(firmware: Path, side: int) -> None:
    with Array(firmware) as array:
        tile = array[0]
        array.run(0.3)
        port, bit = tile.side_pin(side, receiving=True)
        for number in range(3):  # each is longer than a byte and shorter than what counts as low
            start_s = array.time_s + AHEAD_S + 0.04 * number
            tile.push_edge(port, bit, round(start_s * CLOCK_HZ), False)
            tile.push_edge(port, bit, round((start_s + 0.02) * CLOCK_HZ), True)
        array.run(1.0)
        board = last_board(tile)
        assert board.framing_errors == tuple(3 if other == side else 0 for other in range(4))
        assert board.low_ms == (0, 0, 0, 0)
        tile.hold_pin(port, bit, False)
        array.run(1.0)
        board = last_board(tile)
        assert board.framing_errors == tuple(4 if other == side else 0 for other in range(4)), "one break"
        assert [0 < low_ms <= 1000 for low_ms in board.low_ms] == [other == side for other in range(4)]


@pytest.mark.parametrize("volts", [5.0, 4.6, 4.4, 3.3])
def test_the_supply_is_told_and_a_low_one_is_an_error(firmware: Path, volts: float) -> None:
    with Array(firmware) as array:
        array[0].set_supply(volts)
        array[0].set_adc_noise(2.0, seed=1)
        array.run(1.9)
        heard = said(array[0])
    boards = [one for one in heard if isinstance(one, BoardSentence)]
    assert [one.supply_mv for one in boards] == pytest.approx([1000 * volts] * 2, rel=0.005)
    errors = [one for one in heard if isinstance(one, ErrorSentence)]
    assert [one.code for one in errors] == ["SUPPLY"] * (1000 * volts < LEAST_SUPPLY_MV)


def test_the_fuses_are_told_on_request(firmware: Path) -> None:
    with Array(firmware) as array:
        tile = array[0]
        tile.write_eeprom(0, settings_block(7, 100, 0))
        tile.set_fuses(low=0xFF, high=0xD9, extended=0xFC, lock=0xCF)
        array.run(0.3)
        assert any(isinstance(one, ChipSentence) for one in said(tile)), "at the start"
        tile.write_serial(chip_command())
        array.run(0.1)
        assert ChipSentence(7, 0xFF, 0xD9, 0xFC, 0xCF) in said(tile)


def chip_of(array: Array) -> ChipSentence:
    array[0].reset()
    array.run(0.3)
    return next(one for one in said(array[0]) if isinstance(one, ChipSentence))


def test_a_marking_outlives_resets_and_is_replaced_only_when_told(firmware: Path) -> None:
    with Array(firmware) as array:
        tile = array[0]
        tile.write_eeprom(0, settings_block(7, 100, 0) * 2)
        assert chip_of(array).marking is None
        tile.write_serial(mark_command(2, 1017))
        array.run(0.2)
        assert AckSentence(7, "MARK", ("2", "1017")) in said(tile)
        assert chip_of(array).marking == "2.1017"
        tile.write_serial(mark_command(2, 1018))
        array.run(0.2)
        assert NakSentence(7, "MARKED", "MARK") in said(tile)
        assert chip_of(array).marking == "2.1017"
        tile.write_serial(mark_command(2, 1018, replace=True))
        array.run(0.2)
        assert chip_of(array).marking == "2.1018"
        assert tile.read_eeprom(0, 2 * SETTINGS_SIZE) == settings_block(7, 100, 0) * 2


def test_power_may_fail_while_a_marking_is_written(firmware: Path) -> None:
    """A cut at any time leaves the old marking or the new one, and the settings as they are."""
    found: list[str] = []
    with Array(firmware) as array:
        tile = array[0]
        for cut_s in (0.001, 0.004, 0.012, 0.02, 0.03, 0.05, 0.2):
            tile.write_eeprom(0, settings_block(7, 100, 0) * 2 + marking_block(2, 1017) * 2)
            chip_of(array)
            tile.write_serial(mark_command(3, 4321, replace=True))
            array.run(0.002 + cut_s)
            tile.powered = False
            array.run(0.05)
            tile.powered = True
            array.run(0.3)
            chip = next(one for one in said(tile) if isinstance(one, ChipSentence))
            found.append(str(chip.marking))
            assert chip.tile == 7
            assert tile.read_eeprom(MARKING_AT, SETTINGS_SIZE) == (
                marking_block(3, 4321) if chip.marking == "3.4321" else marking_block(2, 1017)
            )
    assert found == sorted(found), "once new, always new"
    assert set(found) == {"2.1017", "3.4321"}
