"""Emulated tiles that say where one is missing: the firmware of `models/damage` on an 0 that loses a tile.

What a tile's LEDs show, what its TILE sentence says, and what the model's twin on this machine makes of the
same state must be one.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from support.alone import alone
from tilenca.base import paths
from tilenca.base.sides import SIDES, opposite
from tilenca.commands.own_firmware import build_beside
from tilenca.emulator import Array
from tilenca.emulator.wiring import cables
from tilenca.model.directions import NOWHERE, missing_sides
from tilenca.model.file import load_model
from tilenca.protocol.commands import set_command
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import AckSentence, HelloSentence, TileSentence, missing_side
from tilenca.shapes.file import load_task

DAMAGE = load_model(paths.MODELS / "damage")
ZERO = load_task(paths.DEFAULT_SHAPES).find("0")
DEAD = ZERO.cells.index((2, 0))  # on the left, in the middle
SETTLED_S, DIES_S = 1.5, 1.5
PERIOD_S = 0.02


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("damage")
    shutil.copytree(paths.MODELS / "damage", folder, dirs_exist_ok=True)
    with alone("pio"):
        return build_beside(DAMAGE, folder)


class Tiles:
    """The tiles of a 0, and what each of them has said last."""

    def __init__(self, image: Path) -> None:
        count = len(ZERO.cells)
        self.array = Array(image, count, cables(ZERO), switch_on_s=[0.01 * n for n in range(count)])
        self.readers = [LineReader() for _ in ZERO.cells]
        self.hello: dict[int, HelloSentence] = {}
        self.last: dict[int, TileSentence] = {}
        self.acks = 0

    def run(self, seconds: float) -> None:
        self.array.run(seconds)
        for number, reader in enumerate(self.readers):
            for _, sentence in reader.feed(self.array[number].read_serial()):
                if isinstance(sentence, HelloSentence):
                    self.hello[number] = sentence
                elif isinstance(sentence, TileSentence):
                    self.last[number] = sentence
                self.acks += isinstance(sentence, AckSentence)

    def lit(self, number: int) -> str:
        leds = self.array[number].leds
        return "".join(side for side, on in zip(SIDES, leds, strict=True) if on)

    def says(self, number: int) -> str:
        return missing_side(self.hello[number], self.last[number])

    def twin_says(self, number: int) -> str:
        """From the state in its last sentence; the stored state is finer, but only its message counts."""
        state = np.frombuffer(self.last[number].state, np.uint8).astype(np.int16) - 128
        side = missing_sides((state << 7)[None], len(DAMAGE.labels))[0]
        return "" if side == NOWHERE else SIDES[side]

    def heard(self) -> list[str]:
        """What each tile says, once a sentence and the LEDs are of the same state."""
        for _ in range(20):
            self.run(PERIOD_S / 2)
            every = [number for number in range(len(ZERO.cells)) if self.array[number].powered]
            said = [self.says(number) for number in every]
            assert said == [self.twin_says(number) for number in every]
            if said == [self.lit(number) for number in every]:
                return said
        raise AssertionError("the LEDs show something else than what the tiles say")


@pytest.fixture
def tiles(image: Path) -> Iterator[Tiles]:
    found = Tiles(image)
    with found.array:
        yield found


def test_the_link_leds_show_by_a_setting_where_a_tile_died(tiles: Tiles) -> None:
    tiles.run(SETTLED_S)
    neighbours = ZERO.neighbours()
    for number, near in enumerate(neighbours):
        assert tiles.hello[number].directions == 4
        assert tiles.lit(number) == "".join(
            side for side, other in zip(SIDES, near, strict=True) if other >= 0
        )
        tiles.array[number].write_serial(set_command("leds", 2))
    tiles.run(0.2)
    assert tiles.acks == len(neighbours)
    assert tiles.heard() == [""] * len(neighbours)

    tiles.array[DEAD].powered = False
    tiles.run(DIES_S)
    beside = {other: SIDES[opposite(side)] for side, other in enumerate(neighbours[DEAD]) if other >= 0}
    wanted = [beside.get(number, "") for number in range(len(neighbours)) if number != DEAD]
    assert sorted(wanted)[-2:] == ["N", "S"]
    assert tiles.heard() == wanted

    tiles.array[DEAD].powered = True
    tiles.run(DIES_S)
    assert tiles.heard() == [""] * len(neighbours)
