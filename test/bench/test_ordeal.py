"""The ordeal of twenty tiles finds nothing broken in the firmware, and finds what is broken on purpose."""

from pathlib import Path

from bench.ordeal import Ordeal, ordeal
from tilenca.protocol.settings import settings_block

SECONDS = 14.0  # three times left alone


def test_twenty_tiles_come_through_and_the_same_seed_does_the_same(firmware: Path) -> None:
    one, two = (ordeal(firmware, SECONDS, seed=7, threads=threads) for threads in (1, 2))
    assert one == two
    assert one.broken == []
    assert one.calms > 1
    assert len(one.deeds) > 4
    assert ordeal(firmware, SECONDS / 4, seed=8, threads=1).deeds != one.deeds


def test_settings_that_nobody_gave_and_a_tile_that_is_silent_are_found(firmware: Path) -> None:
    table = Ordeal(firmware, 1, threads=1)
    with table.array:
        table.calm()
        assert table.findings.broken == []
        one, two, *_ = (table.places[cell] for cell in sorted(table.tiles))
        table.array[one].write_eeprom(0, settings_block(99, 20, 0))
        table.array[two].powered = False
        table.run(2.0)
        table._look()
    assert any(f"tile {one + 1} has settings that nobody gave" in line for line in table.findings.broken)
    assert any(f"tile {two + 1} is stuck" in line for line in table.findings.broken)
    assert len(table.findings.late) == 1
