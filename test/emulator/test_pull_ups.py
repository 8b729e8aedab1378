"""Sides without a neighbour: their inputs float, but for the pull-ups that the firmware turns on.

Each line of the firmware that does so is also taken out of a copy, to see that these tests would notice.
"""

import shutil
from pathlib import Path

import pytest

from support.avr import run_tool
from tilenca.base.paths import FIRMWARE, FIRMWARE_ELF
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array, EmulatedTile, Hardware

SECONDS = 0.3
SEEDS = (1, 2, 3)
# The interrupts by which the firmware hears its sides: receivers of USART2, 1 and 3, pin changes of port K.
HEARS = {NORTH: "__vector_51", EAST: "__vector_36", SOUTH: "__vector_11", WEST: "__vector_54"}
ROWS = "            pull_up(kSideRx[i]);\n"
COLUMN = "    pull_up(kSouthRx);\n"

PROGRAM = """
#include <avr/interrupt.h>
#include "board/chip.h"
#include "board/links.h"
using namespace tilenca;
int main() {
    board::clock_begin();
    board::links_begin();
    sei();
    for (;;) {
        for (uint8_t i = 0; i < kSides; ++i) {
            for (uint8_t byte; board::link_read(side_at(i), &byte);) { }
        }
    }
}
"""


def links(directory: Path, source: str, deleted: str) -> Path:
    """The board's links with a main loop, after a line, if any, was deleted from one of their sources."""
    firmware = directory / "firmware"
    shutil.copytree(FIRMWARE / "src", firmware / "src")
    shutil.copytree(FIRMWARE / "include", firmware / "include")
    text = firmware / "src" / "board" / source
    assert not deleted or text.read_text().count(deleted) == 1, f"{source} has no line {deleted!r} any more"
    text.write_text(text.read_text().replace(deleted, ""))
    (directory / "main.cpp").write_text(PROGRAM)
    board, avr = firmware / "src" / "board", firmware / "src" / "avr"
    sources = [board / f"{name}.cpp" for name in ("chip", "links", "south_uart", "usart")]
    sources += [avr / "south_uart.S", avr / "usart.S", firmware / "src" / "core" / "toggles.cpp"]
    flags = ("-mmcu=atmega2560", "-DF_CPU=16000000UL", "-O2", "-std=gnu++14", "-I", firmware / "include")
    run_tool("avr-g++", *flags, *sources, directory / "main.cpp", "-o", directory / "links.elf")
    return directory / "links.elf"


def hears(tile: EmulatedTile) -> list[int]:
    """The sides that have heard anything since the last call."""
    heard = {mark.function for mark in tile.marks()}
    return [side for side, function in HEARS.items() if function in heard]


def heard_alone(elf: Path, seed: int) -> list[int]:
    with Array(elf, hardware=Hardware(seed=seed)) as array:
        for function in HEARS.values():
            array[0].mark(function)
        array.run(SECONDS)
        return hears(array[0])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_lone_tile_hears_nothing(seed: int) -> None:
    assert heard_alone(FIRMWARE_ELF, seed) == []


@pytest.mark.parametrize(
    ("source", "deleted", "sides"),
    [("links.cpp", ROWS, [NORTH, EAST, WEST]), ("south_uart.cpp", COLUMN, [SOUTH])],
)
def test_without_its_pull_up_a_side_hears_noise(
    tmp_path: Path, source: str, deleted: str, sides: list[int]
) -> None:
    assert heard_alone(links(tmp_path, source, deleted), SEEDS[0]) == sides


def test_the_links_alone_hear_nothing_as_they_are(tmp_path: Path) -> None:
    assert heard_alone(links(tmp_path, "links.cpp", ""), SEEDS[0]) == []
