"""Saving whole arrays, going back, and the same future again."""

import math
import random
import struct
from pathlib import Path

import pytest

from support.avr import Compile, IdealArray
from support.busy_tiles import BUSY, build
from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, NORTH, SOUTH
from tilenca.emulator import Array


def everything(array: Array) -> list[object]:
    return [
        (
            tile.cycles,
            tile.pc,
            tile.read_memory(0, 0x2200),
            tile.read_eeprom(),
            tile.stack,
            tile.read_serial(),
        )
        for tile in array
    ]


def test_a_restored_array_has_the_same_future(avr: Compile) -> None:
    array = build(avr(BUSY))
    array.run(0.0512)
    array[0].write_serial(b"on its way")
    array[1].hold_pin("K", 7, False)
    snapshot = array.save()
    array.run(0.05)
    future, saved = everything(array), array.save()
    array.restore(snapshot)
    assert array.time_s == pytest.approx(0.0512, abs=16e-6)
    array.run(0.05)
    assert everything(array) == future
    assert array.save() == saved


def test_it_is_restored_in_another_array_on_other_threads(avr: Compile) -> None:
    elf = avr(BUSY)
    array = build(elf)
    array.run(0.03)
    snapshot = array.save()
    array.run(0.03)
    other = Array(elf, threads=2)  # one tile, no cables
    other.restore(snapshot)
    assert len(other) == 3
    other.run(0.03)
    assert everything(other) == everything(array)


def test_what_was_added_cut_and_switched_off_since_is_as_before(avr: Compile) -> None:
    array = build(avr(BUSY))
    array.run(0.02)
    snapshot = array.save()
    array.run(0.02)
    future = everything(array)
    array.restore(snapshot)
    array.add_tile()
    array.cut(0, EAST)
    array.remove_tile(2)
    array.run(0.02)
    array.restore(snapshot)
    assert len(array) == 3
    array.run(0.02)
    assert everything(array) == future


PROGRAMMER = """
#include <avr/boot.h>
BOOTLOADER_SECTION __attribute__((noinline)) void fill(uint8_t n) {
    boot_page_erase(0x8000); boot_spm_busy_wait();
    boot_page_fill(0x8000, 0x1100 + n); boot_page_write(0x8000); boot_spm_busy_wait(); boot_rww_enable();
}
int main(void) { for (uint8_t n = 0;; n++) { fill(n); result[0] = pgm_read_byte(0x8000); } }
"""


def test_flash_that_a_tile_has_written_is_its_own_and_part_of_the_snapshot(avr: Compile) -> None:
    array = Array(avr(PROGRAMMER, "-Wl,--section-start=.bootloader=0x3E000"), 2, switch_on_s=[0, 1])
    fresh = array.save()
    array.run(0.0300)
    snapshot, flash = array.save(), array[0].read_flash(0x8000, 4)
    array.run(0.02)
    assert array[0].read_flash(0x8000, 4) != flash
    assert array[1].read_flash(0x8000, 4) == b"\xff" * 4
    array.restore(snapshot)
    assert array[0].read_flash(0x8000, 4) == flash
    array.restore(fresh)
    assert array[0].read_flash(0x8000, 4) == b"\xff" * 4


def test_damaged_snapshots_are_refused_in_one_line(avr: Compile, tmp_path: Path) -> None:
    array = build(avr(BUSY))
    array.run(0.005)
    good = array.save()
    draw = random.Random(11)
    for _ in range(150):
        damaged = bytearray(good[: draw.randrange(len(good))] if draw.random() < 0.4 else good)
        for _ in range(draw.randrange(1, 4)):
            if damaged:
                damaged[draw.randrange(len(damaged))] ^= draw.randrange(1, 256)
        with pytest.raises(UsageError, match=r"^snapshot: [^\n]*; save it anew$"):
            array.restore(bytes(damaged))
    array.restore(good)
    with pytest.raises(UsageError, match="another image"):
        Array(avr("int main(void) { for (;;) { } }")).restore(good)


def forged(snapshot: bytes, place: int, content: bytes) -> bytes:
    """A snapshot with other bytes at a place, and the checksum of that (FNV-1a)."""
    body = snapshot[:place] + content + snapshot[place + len(content) : -4]
    checksum = 2166136261
    for byte in body:
        checksum = (checksum ^ byte) * 16777619 % 2**32
    return body + struct.pack("<I", checksum)


# Magic, version, image and the number of tiles come first.
TILES, WIRES, FIRST_WIRE, WIRE_BYTES = 12, 16, 20, 16


@pytest.mark.parametrize(
    ("place", "content", "reason"),
    [
        (TILES, struct.pack("<I", 0), "more tiles or cables than can be, or none"),
        (TILES, struct.pack("<I", 4096), "more tiles or cables than can be"),
        (WIRES, struct.pack("<I", 13), "more tiles or cables than can be"),
        (FIRST_WIRE, struct.pack("<I", 7), "a cable leads nowhere"),
        (FIRST_WIRE + 8, struct.pack("<I", 0), "one that leads back"),
        (FIRST_WIRE + 12, struct.pack("<I", 2), "one direction only"),
        (-1, struct.pack("<d", math.nan), "a number that no measure takes"),
        (-1, struct.pack("<d", 1e300), "a number that no measure takes"),
        (-1, struct.pack("<d", 100.0), "its time is none"),
        (-1, struct.pack("<d", 256e12), "its time is none"),
    ],
)
def test_what_no_array_saves_is_refused_although_its_checksum_is_right(
    place: int, content: bytes, reason: str, avr: Compile
) -> None:
    array = build(avr(BUSY))
    array.run(0.005)
    good = array.save()
    assert forged(good, 0, good[:4]) == good
    (wires,) = struct.unpack_from("<I", good, WIRES)
    time_at = FIRST_WIRE + wires * WIRE_BYTES
    with pytest.raises(UsageError, match=reason):
        array.restore(forged(good, time_at if place < 0 else place, content))
    array.restore(good)
    assert array.save() == good


def test_whatever_was_refused_a_good_snapshot_brings_the_array_back(avr: Compile) -> None:
    array = build(avr(BUSY))
    array.run(0.005)
    good = array.save()
    refused = 0
    for place in range(FIRST_WIRE, len(good) - 12, 61):  # a prime: they spread over all fields
        try:
            array.restore(forged(good, place, b"\xff" * 8))
        except UsageError:
            refused += 1
        array.restore(good)
        assert array.save() == good
    assert refused > 10


# Toggles its TX to the north, and counts the edges from the south.
TOGGLER = """
static volatile uint16_t edges;
int main(void) {
    DDRH = 2;
    for (uint8_t before = PINK;;) {
        _delay_us(300);
        PORTH ^= 2;
        edges += (PINK ^ before) >> 6 & 1;
        before = PINK;
    }
}
"""


def test_a_cable_that_the_snapshot_does_not_have_can_be_plugged_again(avr: Compile) -> None:
    array = IdealArray(avr(TOGGLER), 2)
    array.run(0.001)
    without = array.save()
    array.link(0, NORTH, 1, SOUTH)
    array.run(0.03)
    edges = array[1].integer("edges")
    assert edges > 50
    array.restore(without)
    array.link(0, NORTH, 1, SOUTH)
    array.run(0.03)
    assert array[1].integer("edges") == edges


def test_a_tile_that_was_added_late_is_saved_before_it_has_run(avr: Compile) -> None:
    array = build(avr(BUSY))
    array.run(0.02)
    array.add_tile()
    snapshot = array.save()
    array.run(0.01)
    future = everything(array)
    array.restore(snapshot)
    array.run(0.01)
    assert everything(array) == future
