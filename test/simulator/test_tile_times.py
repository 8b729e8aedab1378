"""The times that the simulator gives tiles are those of the firmware on emulated tiles."""

from collections import defaultdict

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.base.sides import opposite
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.states import SENDING, StateWatch, TileState
from tilenca.model.cost import computing_ms
from tilenca.model.file import load_model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.shapes.file import Shape
from tilenca.simulator.tile_times import tile_times

pytestmark = pytest.mark.skipif(
    not paths.FIRMWARE_ELF.exists(), reason="run `make setup` to build the firmware"
)
FOUR = Shape("4", ("#.#", "#.#", "###", "..#", "..#"), "4")
WORKING = "tilenca_blocks"  # what the first work of an update calls
CLOCK_PER_MS = 16_000
UNCERTAIN_MS = 0.5  # a tile looks between two slices of work
FIRST_UPDATES = 6  # tell less, and take less time


class Times:
    """When each tile's updates began and ended, in milliseconds of the array, and what they read."""

    def __init__(self) -> None:
        elf, model = paths.FIRMWARE_ELF, load_model(paths.DEFAULT_MODEL)
        settings = EmulationSettings(updates=20, seed=3)
        emulation = Emulation(FOUR, model.labels, elf, settings, firmware_settings(elf))
        self.begins: dict[int, list[float]] = defaultdict(list)
        self.ends: dict[int, list[float]] = defaultdict(list)  # the first one is that of the seed
        self.states: dict[int, list[TileState]] = defaultdict(list)
        with emulation.array:
            watch = StateWatch(emulation.array, model.dimensions.channels)
            for tile in emulation.array:
                tile.mark(SENDING)
                tile.mark(WORKING)
            works = dict.fromkeys(range(len(emulation.array)), True)
            while not emulation.done():
                emulation.advance(0.05)
                for state in watch.collect():
                    self.states[state.tile].append(state)
                for tile in emulation.array:
                    rate = CLOCK_PER_MS * (1 + emulation.ppm[tile.index] * 1e-6)
                    working = emulation.array.code_address(WORKING)
                    for mark in tile.marks():
                        at = emulation.switch_on_s[tile.index] * 1000 + mark.cycle / rate
                        begins = mark.address == working
                        if begins != works[tile.index]:
                            (self.begins if begins else self.ends)[tile.index].append(at)
                        works[tile.index] = begins


@pytest.fixture(scope="module")
def times() -> Times:
    return Times()


def test_an_update_takes_as_long_as_the_cost_says(times: Times) -> None:
    size = load_model(paths.DEFAULT_MODEL).dimensions
    taken: dict[int, list[float]] = defaultdict(list)
    for tile, neighbours in enumerate(FOUR.neighbours()):
        pairs = zip(times.begins[tile], times.ends[tile][1:], strict=False)
        taken[sum(other >= 0 for other in neighbours)] += [end - begin for begin, end in pairs][
            FIRST_UPDATES:
        ]
    assert {1, 2, 3} <= set(taken)
    for count, each in taken.items():
        assert np.mean(each) == pytest.approx(computing_ms(size, count), rel=0.15), count


def test_an_update_reads_the_messages_that_have_arrived_by_the_times_of_tiles(times: Times) -> None:
    sending = np.array(tile_times(load_model(paths.DEFAULT_MODEL).dimensions, DEFAULT_PERIOD_MS).sending)
    checked = 0
    for tile, neighbours in enumerate(FOUR.neighbours()):
        for number, begin in list(enumerate(times.begins[tile], 1))[1:-1]:
            for side, other in enumerate(neighbours):
                if other < 0:
                    continue
                arrivals = np.array(times.ends[other]) + sending[opposite(side)] * DEFAULT_PERIOD_MS
                if not len(arrivals) or arrivals[0] > begin or np.abs(arrivals - begin).min() < UNCERTAIN_MS:
                    continue
                newest = int(np.flatnonzero(arrivals <= begin)[-1])
                sent, heard = times.states[other][newest].message, times.states[tile][number].heard[side]
                assert heard == sent, (tile, number, side)
                checked += 1
    assert checked > 200
