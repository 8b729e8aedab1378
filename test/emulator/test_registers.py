"""Every I/O register against the data sheet's summary, as tools/emulator/src/avr/registers.inc has it.

Reset value, bits that exist, bits that read back: each register is written by a program and read again.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from support.avr import PRELUDE, ROOT, run_tool, words
from support.avr import IdealArray as Array

TABLE = ROOT / "tools" / "emulator" / "src" / "avr" / "registers.inc"
ROW = re.compile(r"TILENCA_(REGISTER|PAIR)\((0x\w+), (\w+), (0x\w+), (0x\w+), (0x\w+), (0x\w+)\)")
FIRST, LAST = 0x20, 0x1FF
PATTERNS = (0xFFFF, 0x0000, 0x5555, 0xAAAA)

# Does what it is told: writes a register, or a pair of them high byte first, and reads it back, low byte
# first.
OBEY = """
#define place result16[0]
#define value result16[1]
#define answer result16[2]
#define is_pair result[6]
#define go result[7]                            /* 1: write and read, 2: read only */
int main(void) {
    go = 0;
    for (;;) {
        while (!go) { }
        volatile uint8_t *at = (volatile uint8_t *)place;
        uint8_t low = value, high = value >> 8, read_low = 0, read_high = 0;
        if (go == 1) {
            if (is_pair) at[1] = high;
            at[0] = low;
        }
        read_low = at[0];
        if (is_pair) read_high = at[1];
        if (place == 0x5D) SP = RAMEND - 8;
        answer = read_low | (uint16_t)read_high << 8;
        go = 0;
    }
}
"""


@dataclass(frozen=True)
class Register:
    """A row of the table; its numbers have 16 bits if it is a pair."""

    name: str
    address: int
    is_pair: bool
    reset: int
    known: int
    exist: int
    kept: int


def rows() -> list[Register]:
    found = []
    for kind, address, name, *numbers in ROW.findall(TABLE.read_text()):
        reset, known, exist, kept = (int(number, 16) for number in numbers)
        found.append(Register(name, int(address, 16), kind == "PAIR", reset, known, exist, kept))
    return found


REGISTERS = rows()


@pytest.fixture(scope="module")
def at_rest(tmp_path_factory: pytest.TempPathFactory) -> Array:
    """A chip that waits for orders."""
    directory = tmp_path_factory.mktemp("registers")
    text, elf = directory / "program.c", directory / "program.elf"
    text.write_text(PRELUDE + OBEY)
    run_tool(
        "avr-gcc", "-mmcu=atmega2560", "-DF_CPU=16000000UL", "-Os", "-std=gnu11", "-Wall", text, "-o", elf
    )
    array = Array(elf)
    array[0].hold_pin("B", 0, True)  # SS: no other master
    array.run(0.001)
    return array


def written(array: Array, address: int, value: int | None, is_pair: bool) -> int:
    """What a program reads of a register after it has written it; with None it only reads."""
    before = array.save()
    order = address.to_bytes(2, "little") + (value or 0).to_bytes(2, "little")
    order += bytes([0, 0, is_pair, 1 if value is not None else 2])
    array[0].write_memory(0x1000, order)
    array.run(0.0001)
    memory = array[0].read_memory(0x1000, 8)
    array.restore(before)
    assert memory[7] == 0, "the program has not come back"
    return words(memory[4:6])[0]


def test_the_table_names_each_address_once() -> None:
    taken = [one.address + offset for one in REGISTERS for offset in range(1 + one.is_pair)]
    assert len(taken) == len(set(taken)), "two rows for one address"
    assert all(FIRST <= address <= LAST for address in taken)
    for one in REGISTERS:
        assert one.kept & ~one.exist == 0, one.name
        assert one.reset & ~one.exist == 0, one.name


# A header that others made from the same data sheet. It lacks RAMPZ1, and has bits of another chip at UDR3.
HEADER_ERRS = {"RAMPZ", "UDR3", "MONDR"}


def test_the_table_has_the_bits_that_avr_libc_names() -> None:
    header = Path("/usr/lib/avr/include/avr/iom2560.h")
    if not header.exists():
        pytest.skip("avr-libc is not installed; run `make setup`")
    named: dict[str, int] = {}
    places: dict[str, int] = {}
    current = ""
    for line in header.read_text().splitlines():
        if register := re.match(r"#\s*define\s+(\w+)\s+_SFR_(IO|MEM)\d+\s*\((0[xX]\w+)\)", line):
            current = register[1]
            places[current] = int(register[3], 16) + (0x20 if register[2] == "IO" else 0)
        elif current and (bit := re.match(r"#\s*define\s+\w+\s+([0-7])\s*(?:/\*.*)?$", line)):
            named[current] = named.get(current, 0) | 1 << int(bit[1])
    ours = {one.name: one for one in REGISTERS}
    for name, address in places.items():
        if name in ours:
            assert ours[name].address == address, name
    for name, bits in named.items():
        if name not in HEADER_ERRS:
            assert ours[name].exist == bits, name
    # What the header names and the table has under the name of its pair, or not at all.
    missing = set(places) - set(ours) - {"MONDR", "ADCW"}
    assert all(name[-1] in "LH" and name[:-1] in ours for name in missing), missing


@pytest.mark.parametrize("register", REGISTERS, ids=[one.name for one in REGISTERS])
def test_a_register_has_its_reset_value(at_rest: Array, register: Register) -> None:
    if register.name in ("SP", "SREG"):  # the program has used them already
        before = at_rest.save()
        at_rest[0].reset()
        read = int.from_bytes(at_rest[0].read_memory(register.address, 1 + register.is_pair), "little")
        at_rest.restore(before)
    else:
        read = written(at_rest, register.address, None, register.is_pair)
    assert read & register.known == register.reset & register.known


@pytest.mark.parametrize("register", REGISTERS, ids=[one.name for one in REGISTERS])
def test_a_register_keeps_the_bits_that_it_has_and_no_others(at_rest: Array, register: Register) -> None:
    for pattern in PATTERNS:
        value = pattern if register.is_pair else pattern & 0xFF
        read = written(at_rest, register.address, value, register.is_pair)
        assert read & register.kept == value & register.kept, f"{value:#x} reads as {read:#x}"
        assert read & ~register.exist == 0, f"{value:#x} reads as {read:#x}"


def test_reserved_addresses_read_as_zero(at_rest: Array) -> None:
    taken = {one.address + offset for one in REGISTERS for offset in range(1 + one.is_pair)}
    for address in range(FIRST, LAST + 1):
        if address not in taken:
            assert written(at_rest, address, 0xFF, False) == 0, hex(address)
