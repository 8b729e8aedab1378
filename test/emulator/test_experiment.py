"""One shape of emulated tiles: how long it runs, and what becomes of it."""

import pytest

from support.avr import Compile
from tilenca.base.errors import TilencaError
from tilenca.base.paths import DEFAULT_SHAPES, FIRMWARE_ELF
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.settings import Settings
from tilenca.shapes.file import load_task

TASK = load_task(DEFAULT_SHAPES)
ONE = TASK.find("1")
# Faster than any firmware: what does not depend on its pace is known sooner.
QUICK = EmulationSettings(updates=20, boot_spread_s=0.1)


def emulation(settings: EmulationSettings) -> Emulation:
    return Emulation(ONE, TASK.labels, FIRMWARE_ELF, settings, firmware_settings(FIRMWARE_ELF))


def test_a_firmware_with_an_empty_eeprom_says_its_defaults() -> None:
    assert firmware_settings(FIRMWARE_ELF) == Settings(0, DEFAULT_PERIOD_MS, 0)


def test_a_program_that_never_greets_has_none(avr: Compile) -> None:
    assert firmware_settings(avr("int main(void) { for (;;) { } }")) is None


def test_it_runs_until_every_tile_has_done_its_updates_and_tells_of_all() -> None:
    run = emulation(QUICK)
    slices = 0

    def count(one: Emulation, heard: list[Heard]) -> None:
        nonlocal slices
        assert one is run
        slices += 1

    assert not run.done()
    run.run(count)
    assert run.done()
    assert slices > 3
    report = run.report(1.5)
    assert report["wall_s"] == 1.5
    assert [(tile["id"], tile["row"], tile["col"], tile["shown"]) for tile in report["tiles"]] == [
        (number + 1, row, col, "1") for number, (row, col) in enumerate(ONE.cells)
    ]
    assert all(tile["updates"] >= QUICK.updates for tile in report["tiles"])
    assert report["all_right"] is run.all_right is True
    assert run.share_right() == 1.0
    agreed_s, agreed_at = run.agreed_at_s(), run.agreed_at_update()
    assert agreed_s is not None
    assert agreed_at is not None
    assert 0 < agreed_s < run.array.time_s
    assert 0 < agreed_at <= QUICK.updates


def test_the_share_that_is_done_grows_with_the_time_asked_for() -> None:
    run = emulation(EmulationSettings(seconds=0.2))
    assert run.share_done() == 0.0
    run.advance(0.05)
    assert run.share_done() == pytest.approx(0.25, abs=0.01)
    run.run(lambda one, heard: None)
    assert run.array.time_s == pytest.approx(0.2, abs=1e-4)


def test_long_slices_hear_the_same_lines_with_the_same_times() -> None:
    said: list[list[Heard]] = []
    reports = []
    for slice_s in (0.05, 0.25):
        running, heard = emulation(EmulationSettings(seconds=1.3)), list[Heard]()
        with running.array:
            running.run(lambda _, lines, heard=heard: heard.extend(lines), slice_s)  # type: ignore[misc]
            reports.append(running.report(0.0))
        said.append(heard)
    assert len(said[0]) > 100
    assert said[0] == said[1]
    assert reports[0] == reports[1]


def test_tiles_without_power_do_not_count_and_no_tile_at_all_is_not_right() -> None:
    run = emulation(EmulationSettings(seconds=0.05))
    for tile in run.array:
        tile.powered = False
    run.advance(0.05)
    assert not run.all_right
    assert run.agreed_at_s() is run.agreed_at_update() is None


def test_the_same_seed_switches_on_at_the_same_times_and_another_at_others() -> None:
    first, again, other = (emulation(EmulationSettings(seed=seed)) for seed in (3, 3, 4))
    assert first.switch_on_s == again.switch_on_s != other.switch_on_s
    assert first.ppm == again.ppm != other.ppm
    assert all(0 <= second <= 1.0 for second in first.switch_on_s)


def test_a_tile_that_does_not_get_its_updates_done_is_named(avr: Compile) -> None:
    elf = avr("int main(void) { for (;;) { } }")
    run = Emulation(ONE, TASK.labels, elf, EmulationSettings(updates=1, boot_spread_s=0.0), None)
    with pytest.raises(TilencaError, match=r"shape '1': tile 1 reported 0 updates .* give --seconds"):
        run.run(lambda one, heard: None)
