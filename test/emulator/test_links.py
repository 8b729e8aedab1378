"""The board's four links alone: what they hear, what they count as lost, and how much noise costs."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from support.avr import run_tool
from support.line_faults import Edges, Vandal, noise, random_bytes
from tilenca.base.paths import FIRMWARE
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array
from tilenca.protocol.constants import LINK_BAUD, ROW_BAUD

SIDES = (NORTH, EAST, SOUTH, WEST)
BAUD = {NORTH: LINK_BAUD, EAST: ROW_BAUD, SOUTH: LINK_BAUD, WEST: ROW_BAUD}
USARTS = (NORTH, EAST, WEST)
SLICE_S = 0.01
# A queue of 64 bytes holds one less.
QUEUE = 63
# Together kReadEveryUs of links.h: how long nobody reads, and what it takes to read all that came meanwhile.
DEAF_S, READING_S = 0.0035, 0.0015

PROGRAM = """
#include <avr/interrupt.h>
#include "board/chip.h"
#include "board/links.h"
using namespace tilenca;
extern "C" {
volatile uint32_t heard[4], turns;
volatile uint16_t lost[4];
volatile uint8_t sums[4], deaf;
}
int main() {
    board::clock_begin();
    board::links_begin();
    sei();
    for (;; ++turns) {
        while (deaf) { }
        for (uint8_t i = 0; i < kSides; ++i) {
            for (uint8_t byte; board::link_read(side_at(i), &byte); ++heard[i]) { sums[i] += byte; }
            lost[i] = board::link_overruns(side_at(i));
        }
    }
}
"""


@pytest.fixture(scope="module")
def elf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The board's links with a main loop that does nothing else."""
    directory = tmp_path_factory.mktemp("links")
    (directory / "main.cpp").write_text(PROGRAM)
    sources = [
        FIRMWARE / "src" / "board" / f"{name}.cpp" for name in ("chip", "links", "south_uart", "usart")
    ]
    sources += [FIRMWARE / "src" / "avr" / f"{name}.S" for name in ("clock", "south_uart", "usart")]
    sources += [FIRMWARE / "src" / "core" / "toggles.cpp", directory / "main.cpp"]
    flags = (
        "-mmcu=atmega2560",
        "-DF_CPU=16000000UL",
        "-O2",
        "-std=gnu++14",
        "-flto",
        "-I",
        FIRMWARE / "include",
    )
    run_tool("avr-g++", *flags, *sources, "-o", directory / "links.elf")
    return directory / "links.elf"


def numbers(array: Array, name: str) -> list[int]:
    raw = array[0].variable(name)
    size = len(raw) // 4
    return [int.from_bytes(raw[at : at + size], "little") for at in range(0, len(raw), size)]


def run(array: Array, seconds: float, vandals: list[Vandal]) -> None:
    end_s = array.time_s + seconds
    while array.time_s < end_s:
        for vandal in vandals:
            vandal.play(array.time_s, array.time_s + SLICE_S)
        array.run(SLICE_S)


def line(data: bytes, start_s: float, baud: float) -> Edges:
    """A line that says these bytes and then rests."""
    time_s, level = start_s, True
    for byte in data:
        bits = byte << 1 | 0x200
        for _ in range(10):
            if bool(bits & 1) != level:
                level = not level
                yield time_s, level
            bits >>= 1
            time_s += 1 / baud


def some_bytes(count: int) -> bytes:
    return bytes(n * n * 7 + n >> 3 & 0xFF for n in range(count))


@pytest.mark.parametrize("error", [-0.02, 0.0, 0.02])
def test_all_sides_hear_every_byte_at_once(elf: Path, error: float) -> None:
    array = Array(elf)
    data = [some_bytes(1000 + side) for side in SIDES]
    vandals = [Vandal(array[0], side, line(data[side], 0.01, BAUD[side] * (1 + error))) for side in SIDES]
    run(array, 0.3, vandals)
    assert numbers(array, "heard") == [len(text) for text in data]
    assert numbers(array, "sums") == [sum(text) & 0xFF for text in data]
    assert numbers(array, "lost") == [0] * 4


def test_what_is_not_read_in_time_is_counted_and_what_comes_later_is_heard(elf: Path) -> None:
    array = Array(elf)
    count = 200
    vandals = [Vandal(array[0], side, line(some_bytes(count), 0.01, BAUD[side])) for side in SIDES]
    address, _ = array.symbol("deaf")
    array.run(0.001)
    array[0].write_memory(address & 0xFFFF, b"\1")
    run(array, 0.1, vandals)
    array[0].write_memory(address & 0xFFFF, b"\0")
    run(array, 0.1, [])
    heard, lost = numbers(array, "heard"), numbers(array, "lost")
    for side in USARTS:
        assert (heard[side], lost[side]) == (QUEUE, count - QUEUE)
    # The south side gives up what it cannot trust.
    assert (heard[SOUTH], lost[SOUTH]) == (0, 1)
    now_s = array.time_s
    run(array, 0.1, [Vandal(array[0], side, line(b"later", now_s + 0.01, BAUD[side])) for side in SIDES])
    assert [after - before for after, before in zip(numbers(array, "heard"), heard, strict=True)] == [5] * 4
    assert numbers(array, "lost") == lost


def test_sides_that_are_read_every_five_milliseconds_lose_nothing(elf: Path) -> None:
    """At full rate, with as many edges as a line can have."""
    array = Array(elf)
    count = 400
    vandals = [Vandal(array[0], side, line(b"\x55" * count, 0.01, BAUD[side])) for side in SIDES]
    for vandal in vandals:
        vandal.play(0.0, 0.2)
    deaf, _ = array.symbol("deaf")
    while array.time_s < 0.15:
        array[0].write_memory(deaf & 0xFFFF, b"\1")
        array.run(DEAF_S)
        array[0].write_memory(deaf & 0xFFFF, b"\0")
        array.run(READING_S)
    assert numbers(array, "lost") == [0] * 4
    assert numbers(array, "heard") == [count] * 4


def spent(elf: Path, edges: Iterator[tuple[float, bool]]) -> float:
    """The share of the main loop's turns that such a south line costs."""
    turns = []
    for vandals in (False, True):
        array = Array(elf)
        run(array, 0.5, [Vandal(array[0], SOUTH, edges)] if vandals else [])
        turns += [array[0].integer("turns")]
    return 1 - turns[1] / turns[0]


def test_random_bytes_at_full_rate_cost_a_quarter_of_the_time(elf: Path) -> None:
    assert spent(elf, random_bytes(LINK_BAUD, 1, 0.01)) < 0.3


@pytest.mark.parametrize(("rate", "most"), [(5e3, 0.1), (4e4, 0.5), (6e4, 0.2), (1e5, 0.1), (1e6, 0.1)])
def test_no_noise_costs_more_than_half_of_the_time(elf: Path, rate: float, most: float) -> None:
    assert spent(elf, noise(rate, 1, 0.01)) < most


def test_noise_is_counted_and_speech_after_it_is_heard(elf: Path) -> None:
    array = Array(elf)
    stormy = (edge for edge in noise(2e5, 1, 0.01))
    run(array, 0.5, [Vandal(array[0], SOUTH, stormy)])
    lost = numbers(array, "lost")[SOUTH]
    assert lost in range(20, 30)  # 20 ms each
    array[0].push_edge(*array[0].side_pin(SOUTH, receiving=True), round((array.time_s + 0.002) * 16e6), True)
    array.run(0.05)
    heard = numbers(array, "heard")[SOUTH]
    run(array, 0.1, [Vandal(array[0], SOUTH, line(b"speech", array.time_s + 0.01, LINK_BAUD))])
    assert numbers(array, "heard")[SOUTH] == heard + 6
