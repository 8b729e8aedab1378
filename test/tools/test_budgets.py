"""The budgets measure what they say: against avr-gcc's own numbers, and on programs made to exceed them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from firmware import budgets, stack
from firmware.disassembly import Program, disassemble, parse
from firmware.elf import Firmware
from tilenca.base import paths

NESTED = """
#include <stdint.h>
#define APART __attribute__((noinline))
volatile int sink;
APART int leaf(volatile char* p) { volatile char b[%d]; for (int i = 0; i < 9; ++i) b[i] = p[i]; return *b; }
APART int middle(int n) {
    volatile char a[%d];
    for (int i = 0; i < 9; ++i) a[i] = n;
    return leaf(a) + a[5] + sink;
}
int main() { sink = middle(3); for (;;); }
"""


def build(directory: Path, source: str, *flags: str) -> Path:
    """The ELF of a C++ program for the ATmega2560."""
    (directory / "program.cpp").write_text(source, encoding="utf-8")
    command = [
        "avr-g++",
        "-mmcu=atmega2560",
        *(flags or ("-Os",)),
        "-fstack-usage",
        "-o",
        "program.elf",
        "program.cpp",
    ]
    subprocess.run(command, cwd=directory, check=True)
    return directory / "program.elf"


def deepest(elf: Path, **indirect: list[str]) -> int:
    return stack.worst_case(parse(disassemble(elf)), indirect)


@pytest.mark.parametrize("flags", [("-Os",), ("-O2",), ("-O0",)])
@pytest.mark.parametrize(("inner", "outer"), [(9, 9), (20, 62), (64, 300), (250, 700)])
def test_a_chain_of_calls_is_as_deep_as_gcc_says(
    tmp_path: Path, flags: tuple[str, ...], inner: int, outer: int
) -> None:
    elf = build(tmp_path, NESTED % (inner, outer), *flags)
    usage = (tmp_path / "program.su").read_text(encoding="utf-8")
    # gcc counts each function's return address, and so do we; nothing else calls anything here.
    assert deepest(elf) == sum(int(line.split("\t")[1]) for line in usage.splitlines())


def listing(*lines: str) -> Program:
    """A program from address 0, each line two bytes, `name:` being a label."""
    text, address = "", 0
    for line in lines:
        if line.endswith(":"):
            text += f"\n{address:08x} <{line[:-1]}>:\n"
        else:
            text += f"  {address:4x}:\t{line}\n"
            address += 2
    return parse(text)


def test_pops_give_back_what_pushes_took() -> None:
    program = listing(
        "main:", "push\tr28", "push\tr29", "pop\tr29", "push\tr0", "pop\tr0", "pop\tr28", "ret\t"
    )
    assert stack.worst_case(program) == 2


def test_both_ways_of_a_branch_are_followed() -> None:
    program = listing("main:", "breq\t.+2\t; 0x4 <main+0x4>", "ret\t", "push\tr0", "push\tr0", "ret\t")
    assert stack.worst_case(program) == 2


def test_a_skipped_instruction_may_also_run() -> None:
    program = listing("main:", "sbrc\tr1, 0", "push\tr0", "ret\t")
    assert stack.worst_case(program) == 1


def test_a_call_of_the_next_instruction_is_a_reservation() -> None:
    program = listing("main:", "rcall\t.+0\t; 0x2 <main+0x2>", "push\tr0", "ret\t")
    assert stack.worst_case(program) == stack.RETURN_ADDRESS + 1


def test_the_deepest_interrupt_comes_on_top() -> None:
    program = listing(
        "main:", "push\tr0", "ret\t", "__vector_1:", "push\tr0", "reti\t", "__vector_2:", "reti\t"
    )
    assert stack.worst_case(program) == 1 + stack.RETURN_ADDRESS + 1


@pytest.mark.parametrize(
    ("lines", "complaint"),
    [
        (["main:", "rcall\t.-2\t; 0x0 <main>", "ret\t"], "recursion: main -> main"),
        (["main:", "eicall\t", "ret\t"], "main calls through a pointer"),
        (["main:", "eijmp\t"], "main jumps through a pointer"),
        (["main:", "ret\t", "__vector_1:", "sei\t", "reti\t"], "__vector_1 enables interrupts"),
        (["main:", "push\tr0"], "where there is no code"),
    ],
)
def test_what_cannot_be_computed_is_refused(lines: list[str], complaint: str) -> None:
    with pytest.raises(stack.StackError, match=re.escape(complaint)):
        stack.worst_case(listing(*lines))


@pytest.mark.parametrize(
    ("source", "flags"),
    [
        (NESTED % (64, 300), ("-O2", "-mcall-prologues")),
        ("volatile int n; int main() { volatile char* p = (char*)__builtin_alloca(n); *p = 1; }", ("-Os",)),
    ],
)
def test_a_stack_pointer_set_from_elsewhere_is_refused(
    tmp_path: Path, source: str, flags: tuple[str, ...]
) -> None:
    with pytest.raises(stack.StackError, match="set to an unknown value"):
        deepest(build(tmp_path, source, *flags))


def test_a_call_through_a_pointer_counts_once_its_targets_are_told() -> None:
    program = listing("main:", "eicall\t", "ret\t", "one:", "push\tr0", "ret\t", "two:", "ret\t")
    assert stack.worst_case(program, {"main": ["one", "two"]}) == stack.RETURN_ADDRESS + 1


def test_switch_tables_are_followed(tmp_path: Path) -> None:
    cases = "".join(f"case {n}: return leaf{n % 3}(x, {n});\n" for n in range(12))
    leaves = "".join(
        f"APART int leaf{n}(int x, int y) {{ volatile char b[{size}]; b[x] = y; return b[y]; }}\n"
        for n, size in enumerate((10, 200, 30))
    )
    source = (
        "#define APART __attribute__((noinline))\n"
        f"volatile int sink;\n{leaves}\n"
        f"APART int choose(int which, int x) {{ switch (which) {{ {cases} }} return 0; }}\n"
        "int main() { for (;;) sink = choose(sink, sink); }\n"
    )
    elf = build(tmp_path, source, "-O2", "-fno-optimize-sibling-calls")
    assert "__tablejump2__" in disassemble(elf), "this test is about a switch that gcc makes a table of"
    assert deepest(elf) > 200


def test_sizes_are_those_of_binutils(tmp_path: Path) -> None:
    source = "int filled[40] = {1, 2}; int empty[70]; int main() { return filled[empty[3]]; }"
    firmware = Firmware(build(tmp_path, source, "-O0"))
    subprocess.run(["avr-objcopy", "-O", "binary", "program.elf", "program.bin"], cwd=tmp_path, check=True)
    assert firmware.flash == (tmp_path / "program.bin").read_bytes()
    size = subprocess.run(
        ["avr-size", "program.elf"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    _, data, bss = (int(number) for number in size.stdout.splitlines()[1].split()[:3])
    assert firmware.sram_bytes == data + bss


def test_each_size_is_held_against_its_own_limit(tmp_path: Path) -> None:
    firmware = Firmware(build(tmp_path, "char taken[500]; int main() { return taken[3]; }", "-O0"))
    limits = {"flash": len(firmware.flash), "sram": firmware.sram_bytes + 100, "stack": 100}
    assert all(finding.holds for finding in budgets.check_sizes(firmware, 100, limits))
    for name in limits:
        findings = budgets.check_sizes(firmware, 100, limits | {name: limits[name] - 1})
        assert [finding.name for finding in findings if not finding.holds] == [name]


FORBIDDEN = budgets.read_budgets()["symbols"]["forbidden"]


@pytest.mark.parametrize(
    ("body", "culprit"),
    [
        ("volatile float x = 2; x = x / 3;", "__divsf3"),
        ("volatile float x = 2; x = x < 3;", "__ltsf2"),
        ("volatile long n = 2; volatile float x = n;", "__floatsisf"),
        ("volatile float x = 2; volatile long n = x;", "__fixsfsi"),
        ("volatile void* p = __builtin_malloc(3);", "malloc"),
    ],
)
def test_software_float_and_heap_are_found_by_name(tmp_path: Path, body: str, culprit: str) -> None:
    finding = budgets.check_symbols(Firmware(build(tmp_path, f"int main() {{ {body} }}", "-O0")), FORBIDDEN)
    assert not finding.holds
    assert culprit in finding.measured


def test_integer_arithmetic_is_welcome(tmp_path: Path) -> None:
    source = "int main() { volatile long a = 5, b = 7; a = a * b / 3; volatile unsigned c = 3; c = c % 2; }"
    assert budgets.check_symbols(Firmware(build(tmp_path, source, "-O0")), FORBIDDEN).holds


def test_the_text_that_bootloaders_stumble_over_is_found(tmp_path: Path) -> None:
    bad = 'const char text[] __attribute__((section(".progmem.data"), used)) = "hey!!!"; int main() {}'
    assert not budgets.check_text(Firmware(build(tmp_path, bad)), "!!!").holds
    assert budgets.check_text(Firmware(build(tmp_path, bad.replace("!!!", "!!"))), "!!!").holds


def test_data_beyond_the_reach_of_lpm_is_found(tmp_path: Path) -> None:
    source = (
        '#define FLASH __attribute__((section(".progmem.data"), used))\n'
        'const char a[30000] FLASH = "a"; const char b[30000] FLASH = "b"; const char c[30000] FLASH = "c";\n'
        "int main() {}"
    )
    firmware = Firmware(build(tmp_path, source))
    assert not budgets.check_flash_data(firmware, below=65536).holds
    assert budgets.check_flash_data(firmware, below=91000).holds


def test_cycles_per_update_are_held_against_the_limit() -> None:
    limit = budgets.read_budgets()["cycles"]["update"]
    finding = budgets.check_cycles(paths.FIRMWARE_ELF, limit)
    assert finding.holds
    measured = int(finding.measured.replace(",", ""))
    assert 0.5 * limit < measured, "a budget that far off finds nothing"
    assert not budgets.check_cycles(paths.FIRMWARE_ELF, measured - 1).holds


def test_other_files_are_refused_with_their_name(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not for an AVR"):
        Firmware(Path(sys.executable).resolve())
    (tmp_path / "text.elf").write_text("hello", encoding="utf-8")
    with pytest.raises(ValueError, match=r"text\.elf: not an ELF file"):
        Firmware(tmp_path / "text.elf")
