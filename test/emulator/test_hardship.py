"""What befalls tiles in the field, a quarter of a minute for twenty of them: the rest go on as before.

The shape is an 8 of twenty tiles. Each test spoils something that the tiles beside it can see, and then asks
all the others: right all the time, never restarted, not one frame damaged on a cable that was left alone.
"""

import random
from collections import Counter
from collections.abc import Iterable

import pytest

from bench.soak import Ledger, checkerboard
from support.line_faults import Edges, Vandal, bursts, noise, random_bytes
from tilenca.base import paths
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array, Link, LinkFault, ResetCause
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.wiring import cables
from tilenca.protocol.constants import LINK_BAUD
from tilenca.protocol.settings import settings_block
from tilenca.shapes.file import load_task
from tilenca.shapes.glyphs import label_of_glyph

pytestmark = pytest.mark.soak

SECONDS = 15.0
SLICE_S = 0.05
# From here on all tiles have to be right.
SETTLED_S = 5.0
PPM_APART = 6000.0
# What is left of the 8 while a tile is away is another shape. Back for so long, it is an 8 again.
BACK_S = 1.0
TASK = load_task(paths.DEFAULT_SHAPES)
LABEL = "8"
SIZE = (7, 4)

# Tiles of the 8, from 0 in reading order:
#    0  1  2  3
#    4        5
#    6        7
#    8  9 10 11
#   12       13
#   14       15
#   16 17 18 19
TOP, MIDDLE, BOTTOM = 1, 9, 18


class Field:
    """The tiles, what becomes of them, and what is done to them."""

    def __init__(self, seed: int) -> None:
        shape = TASK.find(LABEL).stretched(SIZE)
        assert shape is not None
        assert len(shape.cells) == 20
        self.cables: list[Link] = cables(shape)
        self.ppm = checkerboard(shape, PPM_APART)
        draw = random.Random(seed)
        start_s = [draw.uniform(0, 0.1) for _ in shape.cells]
        self.array = Array(paths.FIRMWARE_ELF, len(shape.cells), self.cables, self.ppm, start_s)
        defaults = firmware_settings(paths.FIRMWARE_ELF)
        assert defaults is not None
        self.period_ms = defaults.period_ms
        for tile in self.array:
            tile.write_eeprom(0, settings_block(tile.index + 1, self.period_ms, 0))
        self.ledger = Ledger(self.array)
        self._vandals: list[Vandal] = []
        self.wrong: Counter[int] = Counter()  # at so many looks a tile did not show the label

    def vandalise(self, tile: int, side: int, edges: Edges) -> None:
        """Lets a side without a cable hear that."""
        self._vandals.append(Vandal(self.array[tile], side, edges, self.ppm[tile]))

    def run(self, until_s: float, excused: Iterable[int] = ()) -> None:
        """Runs on, listens, and looks at all tiles but some."""
        watched = set(range(len(self.array))) - set(excused)
        while self.array.time_s < until_s:
            now_s = self.array.time_s
            for vandal in self._vandals:
                vandal.play(now_s, now_s + SLICE_S)
            self.array.run(SLICE_S)
            for _ in self.ledger.listen():
                pass
            if now_s >= SETTLED_S:
                self.wrong += Counter(tile for tile in watched if self.shown(tile) != LABEL)

    def shown(self, tile: int) -> str:
        """The character on a tile's display."""
        return label_of_glyph(self.array[tile].segments, TASK.labels)

    def check(self, excused: Iterable[int] = (), spoilt: Iterable[tuple[int, int]] = ()) -> None:
        """All tiles but some never restarted; all cables but some damaged nothing."""
        excused, spoilt = set(excused), set(spoilt)
        hellos = {tile: count for tile, count in enumerate(self.ledger.hellos) if tile not in excused}
        assert set(hellos.values()) == {1}, hellos
        ends = {end for one in self.cables for end in (one[:2], one[2:])} - spoilt
        whole = [end for end in ends if end[0] not in excused]
        for tile, side in whole:
            frames = self.ledger.frames(tile, side)
            assert (frames.corrupt, frames.lost) == (0, 0), f"tile {tile}, side {side}: {frames}"
            assert frames.received > 0.9 * (SECONDS - SETTLED_S) * 1000 / self.period_ms

    def facing(self, tile: int) -> list[tuple[int, int]]:
        """The sides of other tiles that a cable joins to this one."""
        return [one[2:] for one in self.cables if one[0] == tile] + [
            one[:2] for one in self.cables if one[2] == tile
        ]


def test_garbage_on_all_lines_at_power_on_is_overcome() -> None:
    field = Field(1)
    for tile, side, other, other_side in field.cables:
        field.array.set_fault(tile, side, LinkFault(flip=0.5), seed=1)
        field.array.set_fault(other, other_side, LinkFault(flip=0.5), seed=2)
    for seed, (tile, side) in enumerate(
        [(TOP, SOUTH), (BOTTOM, SOUTH), (MIDDLE, SOUTH), (TOP, NORTH), (0, WEST)]
    ):
        field.vandalise(tile, side, bursts(50_000, seed, 0.8, SECONDS + 1))
    field.run(0.8, range(20))
    for tile, side, other, other_side in field.cables:
        field.array.set_fault(tile, side, LinkFault())
        field.array.set_fault(other, other_side, LinkFault())
    field.run(SECONDS)
    assert not field.wrong
    field.check()


def test_a_neighbour_that_sends_random_bytes_at_full_rate_disturbs_nobody() -> None:
    field = Field(2)
    field.vandalise(TOP, SOUTH, random_bytes(LINK_BAUD, 1))
    field.vandalise(MIDDLE, NORTH, random_bytes(LINK_BAUD, 2))
    field.run(SECONDS)
    assert not field.wrong
    field.check()


def test_a_line_that_is_stuck_low_counts_as_silent() -> None:
    field = Field(3)
    for tile, side in ((TOP, SOUTH), (MIDDLE, NORTH), (19, EAST)):
        field.array[tile].hold_pin(*field.array[tile].side_pin(side, receiving=True), False)
    field.run(SECONDS / 2)
    assert not field.wrong
    # And one between two tiles that talk: they lose each other, and no frame from anybody else. Whether
    # what is left is an 8 is another question.
    field.array.unlink(0, SOUTH)
    field.array[0].hold_pin(*field.array[0].side_pin(SOUTH, receiving=True), False)
    field.array[4].hold_pin(*field.array[4].side_pin(NORTH, receiving=True), False)
    field.run(SECONDS, excused=range(20))
    field.check(spoilt=[(0, SOUTH), (4, NORTH)])
    assert field.array[0].leds == (False, True, False, False)
    assert field.array[4].leds == (False, False, True, False)


@pytest.mark.parametrize("rate", [2_000, 30_000, 200_000])
def test_noise_on_floating_inputs_stops_nobody(rate: float) -> None:
    field = Field(4)
    seconds = SECONDS / 3  # three rates share the time
    for seed, (tile, side) in enumerate([(TOP, SOUTH), (MIDDLE, NORTH)]):
        edges = noise(rate, seed) if rate < 100_000 else bursts(rate, seed, 0.5, 2.5)
        field.vandalise(tile, side, edges)
    field.run(seconds)
    assert not field.wrong
    assert field.ledger.hellos == [1] * 20


def test_a_tile_that_browns_out_again_and_again_takes_nobody_along() -> None:
    field = Field(5)
    draw = random.Random(5)
    while field.array.time_s < SECONDS:
        field.array[MIDDLE].reset(ResetCause.BROWN_OUT)
        field.run(field.array.time_s + draw.choice([0.05, 0.3, BACK_S, BACK_S]), excused=range(20))
        if draw.random() < 0.3:
            field.run(field.array.time_s + BACK_S, excused=range(20))
            field.run(field.array.time_s + BACK_S)
    assert not field.wrong
    field.check(excused=[MIDDLE], spoilt=field.facing(MIDDLE))
    assert field.ledger.hellos[MIDDLE] > SECONDS / 2


def test_a_tile_that_is_pulled_and_plugged_again_and_again_takes_nobody_along() -> None:
    field = Field(6)
    draw = random.Random(6)
    tile = BOTTOM
    field.run(SETTLED_S)
    while field.array.time_s < SECONDS:
        field.array[tile].powered = False
        field.run(field.array.time_s + draw.uniform(0.1, 1.0), excused=range(20))
        field.array[tile].powered = True
        field.run(field.array.time_s + BACK_S, excused=range(20))
        field.run(field.array.time_s + draw.uniform(0.2, 1.5))
    assert not field.wrong
    field.check(excused=[tile], spoilt=field.facing(tile))
