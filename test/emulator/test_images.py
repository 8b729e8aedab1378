"""Loading ELF and Intel HEX files: good ones, wrong ones, damaged ones, and noise."""

import random
import re
from contextlib import suppress
from pathlib import Path

import pytest

from support.avr import Compile, hex_record, run_tool
from tilenca.base.errors import BuildError, TilencaError, UsageError
from tilenca.base.paths import FIRMWARE_ELF
from tilenca.emulator import Array
from tilenca.emulator.library import library

PROGRAM = "EEMEM uint8_t stored = 0x42; int main(void) { result[0] = 7; for (;;) { } }"


def test_an_elf_brings_flash_and_eeprom(avr: Compile) -> None:
    array = Array(avr(PROGRAM + "uint8_t *keep = &stored;"))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1) == b"\x07"
    assert array[0].read_eeprom(0, 2) == b"\x42\xff"


def test_intel_hex_gives_the_same_flash(avr: Compile, tmp_path: Path) -> None:
    elf, hexadecimal = avr(PROGRAM), tmp_path / "program.hex"
    run_tool("avr-objcopy", "-O", "ihex", "-R", ".eeprom", elf, hexadecimal)
    assert Array(hexadecimal)[0].read_flash(0, 4096) == Array(elf)[0].read_flash(0, 4096)


def refused(path: Path, content: bytes) -> str:
    path.write_bytes(content)
    with pytest.raises(UsageError) as caught:
        Array(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert ";" in message
    assert "\n" not in message
    return message


def patched(content: bytes, offset: int, value: int) -> bytes:
    return content[:offset] + value.to_bytes(2, "little") + content[offset + 2 :]


def test_refusals_name_file_fact_and_remedy(avr: Compile, tmp_path: Path) -> None:
    good, bad = avr(PROGRAM).read_bytes(), tmp_path / "bad.elf"
    assert "e_machine 62, AVR is 83" in refused(bad, patched(good, 18, 62))
    assert "AVR architecture 5" in refused(bad, good[:36] + b"\x85" + good[37:])
    assert "truncated: a segment" in refused(bad, good[:200])
    assert "truncated: the header" in refused(bad, good[:20])
    assert "not a linked program" in refused(bad, patched(good, 16, 1))
    assert "neither an ELF nor an Intel HEX" in refused(bad, b"hello, world")
    assert "empty" in refused(bad, b"")
    assert ":1: not a sound Intel HEX record" in refused(bad, b":0000000\n")
    assert "no end record" in refused(bad, b":0100000001FE\n")
    with pytest.raises(UsageError, match="No such file"):
        Array(tmp_path / "missing.elf")
    with pytest.raises(BuildError, match="No such file"):  # what we build ourselves
        Array(FIRMWARE_ELF.with_name("missing.elf"))


def test_an_object_file_is_no_program(avr: Compile, tmp_path: Path) -> None:
    assert "not a linked program" in refused(tmp_path / "object.elf", avr(PROGRAM, "-c").read_bytes())


@pytest.mark.parametrize("kind", ["elf", "hex"])
def test_damaged_images_are_refused_or_loaded_but_never_crash(
    avr: Compile, tmp_path: Path, kind: str
) -> None:
    draw = random.Random(7)
    elf, victim = avr(PROGRAM, "-g"), tmp_path / "victim"
    good = elf.read_bytes()
    if kind == "hex":
        run_tool("avr-objcopy", "-O", "ihex", "-R", ".eeprom", elf, tmp_path / "good.hex")
        good = (tmp_path / "good.hex").read_bytes()
    outcomes = set()
    for _ in range(400):
        damaged = bytearray(good[: draw.randrange(1, len(good))] if draw.random() < 0.2 else good)
        # Most of what can go wrong is said in the headers: half of the damage goes there.
        reach = min(len(damaged), 52 + 3 * 32) if draw.random() < 0.5 else len(damaged)
        for _ in range(draw.randrange(1, 6)):
            damaged[draw.randrange(reach)] = draw.choice([0, 0xFF, 0x7F, 0x80, draw.randrange(256)])
        victim.write_bytes(damaged)
        try:
            with Array(victim):
                outcomes.add("loaded")
        except UsageError as error:
            outcomes.add("refused in one line" if "\n" not in str(error) else str(error))
    # Every record of a HEX file has its checksum; most bytes of an ELF file are not checked by anything.
    assert outcomes == ({"loaded", "refused in one line"} if kind == "elf" else {"refused in one line"})


def test_hex_records_with_sound_checksums_and_senseless_contents_never_crash(tmp_path: Path) -> None:
    draw = random.Random(23)
    victim = tmp_path / "victim.hex"
    outcomes = set()
    for _ in range(400):
        lines = []
        for _ in range(draw.randrange(1, 8)):
            kind = draw.choice([0, 0, 0, 0, 2, 4, 4, 3, 5, 1, 6, 255])
            length = draw.choice([0, 1, 2, 2, 4, 16, 255])
            data = bytes(draw.choice([0, 1, 3, 4, draw.randrange(256)]) for _ in range(length))
            lines.append(hex_record(kind, draw.randrange(65536), data))
        victim.write_text("".join([*lines, ":00000001FF\n"] if draw.random() < 0.8 else lines))
        try:
            with Array(victim) as array:
                array.run(0.0001)
                outcomes.add("ran")
        except TilencaError as error:
            message = str(error)
            outcomes.add("refused" if re.fullmatch(f"{victim}[^\n]*; [^\n]*", message) else message[:14])
    assert outcomes == {"tile 1 stopped", "refused"}


@pytest.mark.parametrize(
    ("record", "fact"),
    [
        (hex_record(4, 0, b"\x00"), ":1: a record of a kind or length that there is not (4)"),
        (hex_record(7, 0, b"\x00"), ":1: a record of a kind or length that there is not (7)"),
        (hex_record(4, 0, b"\x00\x04") + hex_record(0, 0, b"x"), ":2: beyond the 256 KiB of flash"),
        (hex_record(0, 0, b"x")[:-2] + "0\n", ":1: not a sound Intel HEX record"),
    ],
)
def test_a_hex_file_that_makes_no_sense_names_the_line(tmp_path: Path, record: str, fact: str) -> None:
    assert fact in refused(tmp_path / "bad.hex", (record + ":00000001FF\n").encode())


def test_random_programs_stop_or_run_but_never_crash(tmp_path: Path) -> None:
    """Noise as a program: whatever it does to registers, stack and peripherals, the emulator lives."""
    draw = random.Random(5)
    victim, faults = tmp_path / "noise.hex", set[str]()
    for _ in range(60):
        noise = bytes(draw.randrange(256) for _ in range(4096))
        if draw.random() < 0.5:  # most words of noise are ALU instructions: let more of them reach I/O
            words = [draw.choice([0x9300, 0x9200, 0xB800, 0xB000, 0x9A00, 0x9800]) for _ in range(2048)]
            mixed = [
                word | draw.randrange(0x100)
                if n % 2
                else draw.randrange(0x20, 0x140)
                if words[n - 1] in (0x9300, 0x9200)
                else word
                for n, word in enumerate(words)
            ]
            noise = b"".join(word.to_bytes(2, "little") for word in mixed)
        lines = [hex_record(0, start, noise[start : start + 16]) for start in range(0, 4096, 16)]
        victim.write_text("".join([*lines, ":00000001FF\n"]))
        with Array(victim, 2, [(0, 1, 1, 3), (0, 0, 1, 2)]) as array:
            for _ in range(5):
                with suppress(TilencaError):
                    array.run(0.002)
                faults |= {tile.fault for tile in array}
                array[0].powered = False
                array[0].powered = True
            again = array.save()
            array.restore(again)
            assert array.save() == again
    assert len(faults) > 20
    assert all(re.fullmatch("(tile [12] stopped at 0x[0-9A-F]{5}: .+)?", fault) for fault in faults)


def test_arguments_that_do_not_fit_are_refused(avr: Compile) -> None:
    elf = avr(PROGRAM)
    with pytest.raises(UsageError, match="2 clock errors"):
        Array(elf, 3, ppm=[0.0, 1.0])
    with pytest.raises(UsageError, match="tiles are 0 to 1"):
        Array(elf, 2, [(0, 1, 2, 3)])
    with pytest.raises(UsageError, match="beyond"):
        Array(elf)[0].read_memory(0x2000, 0x300)


@pytest.mark.parametrize(
    ("port", "bit"), [(b"I", 0), (b"M", 0), (b"b", 5), (b"@", 0), (b"\xff", 0), (b"B", 8)]
)
def test_pins_that_do_not_exist_are_refused(avr: Compile, port: bytes, bit: int) -> None:
    emulator = library()
    array = Array(avr(PROGRAM))
    pin = (array.handle, 0, port, bit)
    assert emulator.lib.tilenca_tile_pin(*pin) == -1
    assert emulator.lib.tilenca_tile_duty(*pin) == -1
    assert emulator.lib.tilenca_tile_hold_pin(*pin, 0) == -1
    assert emulator.lib.tilenca_tile_push_edge(*pin, 100, 0) == -1
    assert "no pin P" in emulator.last_error()
