"""The ordeal of twenty tiles finds nothing broken in the firmware, and finds what is broken on purpose."""

from pathlib import Path

from bench.ordeal import BEGIN, Progress, ordeal, section
from bench.ordeal_table import SIGN_ON, UPDATES, Ordeal
from bench.publish import written
from tilenca.emulator import ResetCause
from tilenca.protocol.settings import settings_block

SECONDS = 17.0  # three times left alone


def test_twenty_tiles_come_through_and_the_same_seed_does_the_same(firmware: Path) -> None:
    one, two = (ordeal(firmware, SECONDS, seed=7, threads=threads) for threads in (1, 2))
    assert one == two
    assert one.broken == []
    assert one.calms > 1
    assert one.links > 20
    assert one.frames > 1000
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


def test_a_wrong_label_that_stays_is_broken_and_counts_that_are_changed_are_found(firmware: Path) -> None:
    table = Ordeal(firmware, 1, threads=1)
    with table.array:
        table.calm()
        assert table.findings.broken == []
        right, (other, *_) = (
            table.drawing,
            [one for one in table.drawings if one.label != table.drawing.label],
        )
        table.drawing = other
        table._wait_for_the_label()
        table.drawing = right
        (line,) = table.findings.broken
        assert f"updates {other.label} shows {' '.join(right.label * len(table.tiles))}" in line


def test_a_programmer_that_goes_away_leaves_a_tile_that_starts(firmware: Path) -> None:
    table = Ordeal(firmware, 1, threads=1)
    with table.array:
        table.calm()
        index = table.places[min(table.tiles)]
        for said in (SIGN_ON, SIGN_ON[:2]):
            table.array[index].reset(ResetCause.EXTERNAL)
            table.run(0.2)
            table.array[index].write_serial(said)
            table.updates.pop(index)
            table.calm()
        assert table.findings.broken == []


def test_the_result_has_the_memory_at_three_marks_and_goes_into_a_document(firmware: Path) -> None:
    progress = Progress(0.1)
    found = ordeal(firmware, 0.1, 3, 1, progress)
    progress(1.0, found)
    text = section(found, 0.1, 3, progress.memory)
    assert all(f"MB at {share} %" in text for share in (10, 50, 100))
    assert f"within {UPDATES} updates" in text
    document = written("# Benchmarks\n", BEGIN, "<!-- /soak -->", text)
    assert written(document, BEGIN, "<!-- /soak -->", text) == document
