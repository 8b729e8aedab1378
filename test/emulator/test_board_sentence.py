"""What the firmware measures on its board, on each side: supply, framing errors, low lines."""

from pathlib import Path

import pytest

from support.line_faults import AHEAD_S, CLOCK_HZ
from tilenca.base.sides import SIDES
from tilenca.emulator import Array, EmulatedTile
from tilenca.protocol.commands import chip_command
from tilenca.protocol.constants import LEAST_SUPPLY_MV
from tilenca.protocol.sentences import BoardSentence, ChipSentence, ErrorSentence, Sentence, parse_sentence
from tilenca.protocol.settings import settings_block


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
        tile.write_serial(chip_command())
        array.run(0.1)
        assert ChipSentence(7, 0xFF, 0xD9, 0xFC, 0xCF) in said(tile)
