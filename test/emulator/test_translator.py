"""Translated blocks do what the interpreter does, to the byte."""

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from support.avr import Compile, hex_record
from support.busy_tiles import BUSY, build
from tilenca.base.errors import BuildError
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import Array
from tilenca.emulator.translation import SETTING, path_of
from tilenca.emulator.translator import MOST_KEPT, make


@pytest.fixture(autouse=True)
def translations(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of translations of each test's own."""
    place = tmp_path / "translations"
    monkeypatch.setenv(SETTING, str(place))
    return place


# Bits that are fixed, and what they are; the other bits are drawn. All but flow, I/O and the stack.
PATTERNS = [
    *[(0xFC00, code) for code in (0x0400, 0x0800, 0x0C00, 0x1400, 0x1800, 0x1C00)],  # cpc to adc
    *[(0xFC00, code) for code in (0x2000, 0x2400, 0x2800, 0x2C00)],  # and to mov
    *[(0xF000, code) for code in (0x3000, 0x4000, 0x5000, 0x6000, 0x7000, 0xE000)],
    *[(0xFE0F, 0x9400 | low) for low in (0, 1, 2, 3, 5, 6, 7, 10)],  # com to dec
    (0xFC00, 0x9C00),  # mul
    (0xFF00, 0x0100),  # movw
    (0xFF00, 0x0200), (0xFF88, 0x0300), (0xFF88, 0x0308), (0xFF88, 0x0380), (0xFF88, 0x0388),
    (0xFF30, 0x9600), (0xFF30, 0x9700),  # adiw, sbiw of r24
    (0xFE08, 0xF800), (0xFE08, 0xFA00),  # bld, bst
    (0xD208, 0x8000), (0xD208, 0x8008), (0xD208, 0x8200), (0xD208, 0x8208),  # through Y and Z
    *[(0xFE0F, 0x9000 | low) for low in (4, 5, 9, 12, 13)],  # lpm, ld through Y+, X, X+
    *[(0xFE0F, 0x9200 | low) for low in (9, 12, 13)],  # st
    (0xFE0F, 0x9006), (0xFE0F, 0x9007),  # elpm
    (0xFC00, 0x1000), (0xFE08, 0xFC00), (0xFE08, 0xFE00),  # cpse, sbrc, sbrs
    (0xFBF8, 0xF008),  # a branch over the next instruction
    (0xFE0F, 0xB60F), (0xFE0F, 0xBE0F),  # in and out of SREG: interrupts go off and on
    *[(0xFF8F, code) for code in (0x9408, 0x9488)],  # set and clear a flag
]  # fmt: skip
POINTERS = {0x1A: 0x00, 0x1B: 0x10, 0x1C: 0x00, 0x1D: 0x12, 0x1E: 0x00, 0x1F: 0x14}  # X, Y, Z lie in SRAM


def destination(word: int) -> int:
    """The highest register that a word may change, as far as `draw_word` has to know."""
    if word & 0xFF00 == 0x0100:
        return (word >> 4 & 15) * 2 + 1
    if 0x3000 <= word < 0x8000 or word & 0xF000 == 0xE000:
        return 16 + (word >> 4 & 15)
    return word >> 4 & 31


def draw_word(draw: random.Random) -> int:
    while True:
        mask, fixed = draw.choice(PATTERNS)
        word = fixed | draw.getrandbits(16) & ~mask & 0xFFFF
        is_store = word & 0xD200 == 0x8200 or word & 0xFE00 == 0x9200
        is_flag = mask == 0xFF8F and word >> 4 & 7 != 7  # interrupts stay on
        if is_store or is_flag or (mask != 0xFF8F and destination(word) < 26):
            return word


def draw_chain(draw: random.Random) -> list[int]:
    """A number of two to four bytes is added, subtracted or compared, byte by byte."""
    count = draw.randint(2, 4)
    if draw.random() < 0.3:  # SUBI, SBCI
        first = draw.randint(16, 26 - count)
        constant = draw.getrandbits(32)
        codes = [0x5000, 0x4000, 0x4000, 0x4000][:count]
        values = [constant >> 8 * i & 0xFF for i in range(count)]
        return [
            code | (value << 4 & 0xF00) | (first + i - 16) << 4 | (value & 15)
            for i, (code, value) in enumerate(zip(codes, values, strict=True))
        ]
    start, follow = draw.choice([(0x0C00, 0x1C00), (0x1800, 0x0800), (0x1400, 0x0400)])  # ADD, SUB, CP
    first, other = draw.randint(0, 26 - count), draw.randint(0, 32 - count)
    codes = [start, *[follow] * (count - 1)]
    return [
        code | ((other + i) << 5 & 0x200) | (first + i) << 4 | (other + i & 15)
        for i, code in enumerate(codes)
    ]


def random_program(seed: int) -> str:
    """A loop of random instructions, called and interrupted, as an Intel HEX file."""
    draw = random.Random(seed)
    pieces = [draw_chain(draw) if draw.random() < 0.2 else [draw_word(draw)] for _ in range(120)]
    body = [word for piece in pieces for word in piece]
    pointers = [
        0xE000 | (value << 4 & 0xF00) | (value & 15) | (reg - 16) << 4 for reg, value in POINTERS.items()
    ]
    function = [*pointers, *body, 0x0000, 0x0000, 0x9508]  # NOPs for what skips or branches at the end; RET
    vectors = [0x9518, 0x0000] * 57  # RETI
    # TCCR0B = 1, TIMSK0 = 1, SEI, and the loop: RCALL, PUSH R5, POP R6, RJMP.
    prepare = [0xE001, 0xBD05, 0x9300, 0x006E, 0x9478]
    loop = [0xD000 | 3, 0x925F, 0x906F, 0xCFFC]
    vectors[:2] = [0x940C, len(vectors)]
    code = b"".join(word.to_bytes(2, "little") for word in [*vectors, *prepare, *loop, *function])
    records = [hex_record(0, start, code[start : start + 16]) for start in range(0, len(code), 16)]
    return "".join(records) + ":00000001FF\n"


@pytest.mark.parametrize("seed", range(6))
def test_random_programs_leave_the_same_snapshot(tmp_path: Path, seed: int) -> None:
    image = tmp_path / "random.hex"
    image.write_text(random_program(seed))
    make(image)
    ends = []
    for translated in (False, True):
        array = Array(image, 2, [(0, EAST, 1, WEST)], [1000, -1000], translated=translated)
        assert array.is_translated == translated
        array.run(0.021)
        ends.append(array.save())
    assert ends[0] == ends[1]


def test_busy_tiles_leave_the_same_snapshot_on_any_number_of_threads(avr: Compile) -> None:
    elf = avr(BUSY)
    make(elf)
    ends = []
    for translated, threads in ((False, 1), (True, 1), (True, 2)):
        array = build(elf, threads, translated)
        for _ in range(7):
            array.run(0.0113)
        ends.append(array.save())
    assert ends[1:] == ends[:1] * 2


def test_the_firmware_leaves_the_same_snapshot() -> None:
    make(FIRMWARE_ELF)
    links = [(0, EAST, 1, WEST), (0, SOUTH, 2, NORTH), (1, SOUTH, 3, NORTH), (2, EAST, 3, WEST)]
    ends = []
    for translated in (False, True):
        array = Array(FIRMWARE_ELF, 4, links, [900, -900, 0, 50], translated=translated)
        array.run(0.4)
        ends.append(array.save())
    assert ends[0] == ends[1]


def test_marks_and_steps_see_every_instruction_of_a_translated_program(avr: Compile) -> None:
    elf = avr(BUSY)
    make(elf)
    seen = []
    for translated in (False, True):
        array = build(elf, translated=translated)
        array.run(0.0101)
        array[0].mark("main")
        array[0].mark("__vector_17")
        array.run(0.0101)
        array[0].halt()
        counters = [array[0].step() and array[0].pc for _ in range(40)]
        array[0].resume()
        array.run(0.0101)
        seen.append((array[0].marks(), counters, array.save()))
    assert len(seen[0][0]) > 5
    assert seen[0] == seen[1]


PROGRAMMER = """
#include <avr/boot.h>
BOOTLOADER_SECTION __attribute__((noinline)) void fill(uint8_t n) {
    boot_page_erase(0x8000); boot_spm_busy_wait();
    boot_page_fill(0x8000, 0x1100 + n); boot_page_write(0x8000); boot_spm_busy_wait(); boot_rww_enable();
}
int main(void) { for (uint8_t n = 0;; n++) { fill(n); result[0] = pgm_read_byte(0x8000); } }
"""


def test_a_tile_that_programs_itself_goes_on_without_blocks(avr: Compile) -> None:
    elf = avr(PROGRAMMER, "-Wl,--section-start=.bootloader=0x3E000")
    make(elf)
    ends = []
    for translated in (False, True):
        array = Array(elf, 2, switch_on_s=[0, 0.011], translated=translated)
        array.run(0.05)
        ends.append(array.save())
    assert ends[0] == ends[1]


def test_without_a_compiler_there_is_no_translation(
    avr: Compile, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    elf = avr("int main(void) { for (;;) { } }")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BuildError, match=r"not translated; install g\+\+"):
        make(elf)
    array = Array(elf)
    array.run(0.001)
    assert not array.is_translated


def test_translations_of_other_builds_do_not_pile_up(avr: Compile, translations: Path) -> None:
    translations.mkdir()
    for number in range(MOST_KEPT + 5):
        old = translations / f"{number:032x}.so"
        old.touch()
        os.utime(old, (number, number))
    (translations / "libmine.so").touch()  # of another program
    os.utime(translations / "libmine.so", (0, 0))
    made = make(avr("int main(void) { for (;;) { } }"))
    left = {path.name for path in translations.glob("*.so")}
    assert left == {made.name, "libmine.so", *(f"{number:032x}.so" for number in range(6, MOST_KEPT + 5))}


def test_the_module_prints_where_it_put_the_translation(avr: Compile) -> None:
    elf = avr("int main(void) { for (;;) { } }")
    command = [sys.executable, "-m", "tilenca.emulator.translator", str(elf)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == f"{path_of(elf)}\n"
    assert Array(elf).is_translated
