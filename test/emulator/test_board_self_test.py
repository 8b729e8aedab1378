"""The self-test of the board test: boards made faulty on purpose, and each fault found by its name."""

import zlib
from collections.abc import Callable
from pathlib import Path

import pytest

from support.firmware import board_test_image
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array, EmulatedTile
from tilenca.emulator.board_faults import Plug
from tilenca.emulator.serve import STOCK_BOOTLOADER
from tilenca.protocol.board_test import board_test_text

START_S, STEP_S = 1.3, 0.001
STEPS = ("supply", "fuses", "bootloader", "EEPROM", "link LEDs", "pins", "clock", "self-test")


@pytest.fixture(scope="module")
def elf() -> Path:
    """The image of the environment `board_test`."""
    return board_test_image()


def results(tile: EmulatedTile) -> dict[str, list[str]]:
    """What was said of each step."""
    found: dict[str, list[str]] = {}
    for raw in tile.read_serial().splitlines():
        assert board_test_text(raw) is not None, raw
        step, _, result = raw.decode().partition(": ")
        found.setdefault(step, []).append(result)
    return found


def self_tested(
    array: Array, seconds: float = 3.0, go_on: Callable[[], object] | None = None
) -> dict[str, list[str]]:
    """The results of a self-test of the first tile; `go_on` is called every millisecond meanwhile."""
    array.run(START_S)
    tile = array[0]
    tile.read_serial()
    tile.write_serial(b"t")
    end_s = array.time_s + seconds
    while array.time_s < end_s:
        array.run(STEP_S if go_on else seconds)
        if go_on:
            go_on()
    return results(tile)


def alone_with(elf: Path, fault: Callable[[EmulatedTile], object] = lambda tile: None) -> Array:
    """A tile with a bootloader, and one fault."""
    array = Array(elf, bootloader=STOCK_BOOTLOADER)
    fault(array[0])
    return array


def failed(found: dict[str, list[str]]) -> dict[str, list[str]]:
    """The steps that failed."""
    return {
        step: [line for line in found[step] if line.startswith("FAIL")]
        for step in found
        if any(line.startswith("FAIL") for line in found[step])
    }


def test_a_board_in_order_passes_every_step(elf: Path) -> None:
    found = self_tested(alone_with(elf))
    assert found.keys() >= set(STEPS)
    assert failed(found) == {}
    assert found["supply"] == ["pass, 5006 mV"]
    assert found["fuses"] == ["pass, low FF high D8 extended FD lock CF"]
    assert found["bootloader"][0].startswith("pass, hidden by its lock bits")
    assert found["clock"] == ["not tested, no tile with this firmware beside it"]
    assert found["self-test"] == ["pass"]


def test_a_low_regulator_is_named(elf: Path) -> None:
    found = failed(self_tested(alone_with(elf, lambda tile: tile.set_supply(4.3))))
    assert found.keys() == {"supply", "self-test"}
    assert found["supply"][0].startswith("FAIL, 4299 mV, and 16 MHz need 4500: the regulator")
    assert found["self-test"] == ["FAIL, 1 of its steps"]


@pytest.mark.parametrize(
    ("fuses", "said"),
    [
        ({"low": 0xF7}, "FAIL, low F7 high D8 extended FD"),
        ({"extended": 0xFF}, "FAIL, low FF high D8 extended FF"),
        ({"high": 0xD0}, "FAIL, low FF high D0 extended FD"),
    ],
)
def test_a_wrong_fuse_is_named(elf: Path, fuses: dict[str, int], said: str) -> None:
    right = {"low": 0xFF, "high": 0xD8, "extended": 0xFD}
    found = failed(self_tested(alone_with(elf, lambda tile: tile.set_fuses(**(right | fuses)))))
    assert found["fuses"][0].startswith(said)
    assert found["fuses"][0].endswith("and a Mega has FF D8 FD: set them with a programmer")


def test_a_bootloader_is_missing_or_named(elf: Path) -> None:
    with Array(elf) as array:
        assert self_tested(array)["bootloader"] == ["FAIL, none: write one with a programmer"]
    right = {"low": 0xFF, "high": 0xD8, "extended": 0xFD, "lock": 0xFF}
    found = self_tested(alone_with(elf, lambda tile: tile.set_fuses(**right)))
    with alone_with(elf) as array:
        section = array[0].read_flash(0x3E000, 0x2000)
    assert found["bootloader"] == [f"pass, id {zlib.crc32(section):08X}"]


def test_an_eeprom_that_does_not_keep_is_named_and_a_good_one_keeps_what_it_had(elf: Path) -> None:
    with alone_with(elf, lambda tile: tile.write_eeprom(255, b"\x5a")) as array:
        assert failed(self_tested(array)) == {}
        assert array[0].read_eeprom(250, 10) == b"\xff" * 5 + b"\x5a" + b"\xff" * 4
    array = alone_with(elf)
    found = failed(self_tested(array, 1.0, lambda: array[0].write_eeprom(255, b"\x00")))
    assert found["EEPROM"] == ["FAIL, wrote 55 and read 00: the chip keeps no settings"]


@pytest.mark.parametrize(
    ("level", "fact"), [(1023, "is missing, or the wrong way round"), (0, "has a short")]
)
def test_a_link_led_that_is_missing_or_has_a_short_is_named(elf: Path, level: int, fact: str) -> None:
    found = failed(self_tested(alone_with(elf, lambda tile: tile.set_analog(8 + 2, level))))
    assert found["link LEDs"] == [f"FAIL, LED 3 {fact}: PK2"]


@pytest.mark.parametrize(
    ("one", "other", "said"),
    [
        (("H", 4), ("H", 3), "PH4 and PH3"),
        (("B", 7), ("B", 6), "PB7 and PB6"),
        (("B", 5), ("K", 1), "PB5 and PK1"),
    ],
)
def test_two_pins_that_are_joined_are_named(
    elf: Path, one: tuple[str, int], other: tuple[str, int], said: str
) -> None:
    array = alone_with(elf)
    tile = array[0]

    def bridge() -> None:
        tile.hold_pin(*other, tile.pin(*one))

    found = failed(self_tested(array, go_on=bridge))
    assert found["pins"] == [f"FAIL, {said} are joined: look for a bridge of solder"]


@pytest.mark.parametrize(("pin", "name"), [(("H", 4), "PH4"), (("E", 3), "PE3"), (("K", 3), "PK3")])
def test_a_pin_that_stays_high_is_named(elf: Path, pin: tuple[str, int], name: str) -> None:
    found = failed(self_tested(alone_with(elf, lambda tile: tile.hold_pin(*pin, True))))
    assert found["pins"] == [f"FAIL, {name} stays high: a short to the supply"]


@pytest.mark.parametrize(("percent", "well"), [(0.0, True), (1.0, True), (2.5, False), (-2.5, False)])
def test_a_resonator_is_measured_by_the_tile_beside_it(elf: Path, percent: float, well: bool) -> None:
    """One that is fast cannot be read over USB any more: 115,200 baud are 2.1 % fast already."""
    links = [(0, WEST, 1, EAST), (0, NORTH, 2, SOUTH)]
    array = Array(elf, 3, links, [0, 10_000 * percent, 0], [0, 0.01, 0.02], bootloader=STOCK_BOOTLOADER)
    found = self_tested(array, 7.0)
    [other] = [line for line in found["clock"] if " on N is " in line]
    [line] = [line for line in found["clock"] if " on W is " in line]
    assert other.startswith("pass, the neighbour on N is 0 permille")
    permille, _, how = line.split(" is ")[1].split(":")[0].split()
    assert float(permille) == pytest.approx(abs(10 * percent), abs=1.5)
    assert how == ("faster" if percent > 0 else "slower")
    assert line.startswith("pass") == well
    assert ("clock" in failed(found)) == (not well)


def test_loop_back_plugs_pass_at_both_rates(elf: Path) -> None:
    array = alone_with(elf)
    plugs = [Plug(array, array[0], side) for side in (NORTH, EAST, SOUTH, WEST)]

    def play() -> None:
        for plug in plugs:
            plug.play()

    found = self_tested(array, 3.5, play)
    assert [found[f"rate {side}"] for side in "NEW"] == [
        ["pass, loop-back at 125000 baud"],
        ["pass, loop-back at 38400 baud"],
        ["pass, loop-back at 38400 baud"],
    ]
    array[0].write_serial(b"s")
    for _ in range(1500):
        array.run(STEP_S)
        play()
    said = results(array[0])
    assert [said[f"side {side}"][-1] for side in "NESW"] == ["pass, loop-back"] * 4, (
        "at their own rates again"
    )


def test_the_watchdog_starts_the_program_again(elf: Path) -> None:
    with alone_with(elf) as array:
        array.run(START_S)
        array[0].write_serial(b"w")
        array.run(2.5)
        said = results(array[0])
        assert said["watchdog"][-1] == "pass, it has started the program again"
