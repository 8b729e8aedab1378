"""What a hand does: each command comes to the tile that it names, or is refused in words."""

from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.emulator.arrangement import Arrangement
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.by_hand import do_by_hand, tile_of
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.stream_fields import MOST_TILES
from tilenca.shapes.file import Shape


def test_each_command_reaches_its_tile(firmware: Path) -> None:
    shape = Shape("-", ("###",), "-")
    settings = EmulationSettings(boot_spread_s=0.0)
    emulation = Emulation(shape, tuple("0123456789"), firmware, settings, firmware_settings(firmware))
    with emulation.array as array:
        board = Arrangement(emulation, shape.cells)
        for command in (
            hands.Put(1, 1),
            hands.Pull("tile-01"),
            hands.Move("tile-03", 2, 1),
            hands.Shift(("tile-02", "tile-04"), -1, 0),
            hands.Turn("tile-02"),
            hands.Skew("tile-04", -250.0),
            hands.Power("tile-03", False),
            hands.Cut("tile-04", "N"),
        ):
            do_by_hand(board, command)
        assert board.places == {1: (-1, 1), 3: (0, 1), 2: (2, 1)}
        assert [board.fault_of(tile) for tile in (1, 2, 3)] == [(True, 0.0), (False, 0.0), (False, -250.0)]
        assert len(board.cut) == 1
        assert not array[2].powered
        do_by_hand(board, hands.Arrange(((0, 0), (0, 1))))
        assert set(board.places.values()) == {(0, 0), (0, 1)}
        do_by_hand(board, hands.Noise(0.25))
        assert emulation.faults.everywhere == {"loss": 0.25}


def test_a_tile_that_is_not_there_and_one_too_many_are_refused(firmware: Path) -> None:
    rows = ("#" * MOST_TILES,)
    settings = EmulationSettings(boot_spread_s=0.0)
    emulation = Emulation(Shape("-", rows, "-"), ("0",), firmware, settings, firmware_settings(firmware))
    with emulation.array:
        board = Arrangement(emulation, [(0, col) for col in range(MOST_TILES)])
        assert tile_of(board, "tile-02") == 1
        with pytest.raises(UsageError, match="no tile tile-999 lies on the board"):
            do_by_hand(board, hands.Reset("tile-999"))
        with pytest.raises(UsageError, match="which is all; take one out first"):
            do_by_hand(board, hands.Put(1, 0))
