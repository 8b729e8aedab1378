"""Steps of emulated tiles are those of the simulator."""

import math
from types import SimpleNamespace
from typing import cast

from tilenca.emulator.experiment import Emulation
from tilenca.emulator.types import DisplayChange
from tilenca.model import cost
from tilenca.model.file import Dimensions
from tilenca.shapes.glyphs import GLYPHS, label_of_glyph
from tilenca.sweep.steps import FIRST_MS, right_since

SIZE, PERIOD_MS = Dimensions(24, 96, 96), 20


def ended(*updates: int, ppm: tuple[float, ...], on_s: tuple[float, ...], right: bool = True) -> Emulation:
    """A row of tiles; each shows the 4 from one of its updates on, counted from 0, and before it a 7."""
    ends = [0] * len(updates)
    cables = [(tile, 1, tile + 1, 3) for tile in range(len(updates) - 1)]
    for one, _, other, _ in cables:
        ends[one] += 1
        ends[other] += 1
    tiles: list[SimpleNamespace] = []
    for update, rate, begin_s, neighbours in zip(
        updates, [1 + p * 1e-6 for p in ppm], on_s, ends, strict=True
    ):
        shown_s = (
            begin_s + (FIRST_MS + update * PERIOD_MS + cost.computing_ms(SIZE, neighbours)) / rate / 1000
        )
        changes = [DisplayChange(0.1, GLYPHS["7"]), DisplayChange(shown_s, GLYPHS["4"])]
        tiles.append(SimpleNamespace(display_changes=changes, index=len(tiles), powered=True))
    running = SimpleNamespace(
        all_right=right, ppm=ppm, switch_on_s=on_s, cables=cables, label=label_of_glyph, array=tiles
    )
    running.shape = SimpleNamespace(label="4")
    emulation = cast(Emulation, running)
    running.standing = lambda: Emulation.standing(emulation)
    running.right_from_s = lambda tiles: Emulation.right_from_s(emulation, tiles)
    return emulation


def test_a_step_ends_with_an_update_of_the_last_tile() -> None:
    for update in range(30):
        alone = ended(update, ppm=(3000.0,), on_s=(0.7,))
        assert right_since(alone, SIZE, PERIOD_MS) == 1 + update


def test_updates_of_other_tiles_count_by_their_own_clocks() -> None:
    """The first one's update 12 begins 2 ms after the second one's update 2, and ends in the same step."""
    tiles = ended(12, 2, ppm=(0.0, 0.0), on_s=(0.0, 0.198))
    assert right_since(tiles, SIZE, PERIOD_MS) == 3
    assert right_since(ended(12, 2, ppm=(0.0, 0.0), on_s=(0.0, 0.194)), SIZE, PERIOD_MS) == 4
    assert right_since(ended(3, 2, ppm=(3000.0, -3000.0), on_s=(0.0, 0.5)), SIZE, PERIOD_MS) == 3


def test_tiles_that_were_right_before_the_last_one_came_are_right_in_its_first_step() -> None:
    assert right_since(ended(1, 0, ppm=(0.0, 0.0), on_s=(0.0, 0.5)), SIZE, PERIOD_MS) == 1


def test_tiles_that_are_not_all_right_never_are() -> None:
    assert right_since(ended(1, ppm=(0.0,), on_s=(0.0,), right=False), SIZE, PERIOD_MS) == math.inf


def test_tiles_without_power_are_not_asked() -> None:
    tiles = ended(3, 9, ppm=(0.0, 0.0), on_s=(0.5, 0.6))
    assert right_since(tiles, SIZE, PERIOD_MS) == 10
    tiles.array[1].powered = False
    assert right_since(tiles, SIZE, PERIOD_MS) == 4
