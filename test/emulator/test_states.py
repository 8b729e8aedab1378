"""The states of emulated tiles, read where they begin to tell them."""

from collections import Counter

import pytest

from support.avr import Compile
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array
from tilenca.emulator.states import StateWatch, TileState
from tilenca.model.file import load_model
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import HelloSentence, TileSentence

CHANNELS = load_model(paths.DEFAULT_MODEL).dimensions.channels
SECONDS = 0.6


def watched(array: Array) -> list[TileState]:
    watch = StateWatch(array, CHANNELS)
    states: list[TileState] = []
    while array.time_s < SECONDS:
        array.run(SECONDS - array.time_s)
        states += watch.collect()
    return states


def test_each_update_of_each_tile_is_read_once_and_as_the_tile_reports_it() -> None:
    with Array(FIRMWARE_ELF, 2, [(0, EAST, 1, WEST)], ppm=[2000.0, -1000.0]) as array:
        states = watched(array)
        said = [[s for _, s in LineReader().feed(tile.read_serial())] for tile in array]
    for tile in range(2):
        mine = [state for state in states if state.tile == tile]
        hello = next(s for s in said[tile] if isinstance(s, HelloSentence))
        assert hello.channels == CHANNELS
        assert [state.began for state in mine] == [True] + [False] * (len(mine) - 1)
        for report in (s for s in said[tile] if isinstance(s, TileSentence)):
            told = bytes((byte + 128) % 256 for byte in mine[report.updates].message)
            assert bytes(report.state) == told, f"update {report.updates}"
    assert all(not any(state.heard[side]) for state in states for side in (0, 2)), "nobody is there"


def test_an_update_reads_what_its_neighbour_has_sent() -> None:
    with Array(FIRMWARE_ELF, 2, [(0, EAST, 1, WEST)]) as array:
        states = watched(array)
    sent = [{state.message for state in states if state.tile == tile} for tile in range(2)]
    heard = [state.heard[EAST] for state in states if state.tile == 0 and any(state.heard[EAST])]
    assert len(heard) > 20
    assert set(heard) <= sent[1]


def test_watched_tiles_do_what_they_do_unwatched() -> None:
    def said(is_watched: bool) -> list[bytes]:
        with Array(FIRMWARE_ELF, 2, [(0, EAST, 1, WEST)], ppm=[2000.0, -1000.0]) as array:
            if is_watched:
                assert len(Counter(state.tile for state in watched(array))) == 2
            else:
                array.run(SECONDS)
            return [tile.read_serial() for tile in array]

    assert said(is_watched=True) == said(is_watched=False)


def test_a_program_that_sends_no_frames_is_refused(avr: Compile) -> None:
    with Array(avr("int main(void) { for (;;) { } }")) as array, pytest.raises(UsageError, match="states"):
        StateWatch(array, CHANNELS)
