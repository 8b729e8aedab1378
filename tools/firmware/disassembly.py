"""An AVR program as instructions by address, parsed from objdump's output."""

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

_LABEL = re.compile(r"^([0-9a-f]{8}) <(.+)>:$")
_CODE = re.compile(r"^\s+([0-9a-f]+):\t(\w+)(?:\t([^;]*))?(?:;\s*(.*))?$")
_TARGET = re.compile(r"0x([0-9a-f]+)")

# The instructions of four bytes; all others have two.
_LONG = {"call", "jmp", "lds", "sts"}


@dataclass(frozen=True)
class Instruction:
    """One line of the disassembly."""

    address: int
    name: str
    operands: str
    target: int | None

    @property
    def next(self) -> int:
        """The address after it, in bytes."""
        return self.address + (4 if self.name in _LONG else 2)


@dataclass
class Program:
    """A disassembled program: its instructions by address and its functions by name."""

    code: dict[int, Instruction] = field(default_factory=dict)
    functions: dict[str, int] = field(default_factory=dict)

    def name_at(self, address: int) -> str:
        """The function that an address lies in."""
        starts = [(start, name) for name, start in self.functions.items() if start <= address]
        return max(starts)[1] if starts else f"{address:#x}"


def disassemble(elf: Path, objdump: str = "avr-objdump") -> str:
    """The disassembly of all code of an ELF file.

    Raises:
        OSError, subprocess.CalledProcessError: objdump is missing or failed.
    """
    command = [objdump, "-d", "--no-show-raw-insn", str(elf)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def parse(listing: str) -> Program:
    """Parses the text of `disassemble`."""
    program = Program()
    for line in listing.splitlines():
        if label := _LABEL.match(line):
            program.functions[label.group(2)] = int(label.group(1), 16)
        elif code := _CODE.match(line):
            address, name, operands, comment = code.groups()
            operands = (operands or "").strip()
            # Relative jumps carry their target only in objdump's comment, absolute ones there as well.
            target = _TARGET.search(comment or "")
            number = int(target.group(1), 16) if target else None
            program.code[int(address, 16)] = Instruction(int(address, 16), name, operands, number)
    return program
