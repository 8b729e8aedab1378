"""Measures the built firmware against budgets.toml: python -m firmware.budgets FIRMWARE.elf."""

import argparse
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from firmware import cost_fit, stack
from firmware.disassembly import disassemble, parse
from firmware.elf import Firmware
from tilenca.base.errors import TilencaError
from tilenca.protocol.constants import DEFAULT_PERIOD_MS

BUDGETS = Path(__file__).with_name("budgets.toml")


@dataclass(frozen=True)
class Finding:
    """One budget and its result.

    Attributes:
        name: what is measured.
        measured: in words.
        limit: in words.
        holds: whether the limit is kept.
        value: the number and its unit, of what is a number.
    """

    name: str
    measured: str
    limit: str
    holds: bool
    value: tuple[float, str] | None = None


def read_budgets() -> dict[str, Any]:
    """The tables of budgets.toml."""
    return tomllib.loads(BUDGETS.read_text(encoding="utf-8"))


def check_sizes(firmware: Firmware, stack_bytes: int, limits: dict[str, int]) -> list[Finding]:
    """Compares the image's use of each memory with its limit.

    Args:
        firmware: the image.
        stack_bytes: its deepest stack.
        limits: table `bytes` of budgets.toml: flash, sram (variables and stack together), stack.
    """
    measured = {
        "flash": len(firmware.flash),
        "sram": firmware.sram_bytes + stack_bytes,
        "stack": stack_bytes,
    }
    return [
        Finding(name, f"{size:,} bytes", f"{limits[name]:,}", size <= limits[name], (size, "bytes"))
        for name, size in measured.items()
    ]


def check_flash_data(firmware: Firmware, below: int) -> Finding:
    """Whether all constants in flash end where LPM reaches."""
    end = max((symbol.address + symbol.size for symbol in firmware.flash_data()), default=0)
    return Finding("end of data in flash", f"{end:#x}", f"{below:#x}", end <= below)


def check_symbols(firmware: Firmware, forbidden: list[str]) -> Finding:
    """Whether the image is free of functions that must not be linked into it."""
    pattern = re.compile("|".join(f"(?:{expression})" for expression in forbidden))
    found = sorted({symbol.name for symbol in firmware.symbols if pattern.fullmatch(symbol.name)})
    return Finding("forbidden functions", ", ".join(found) or "none", "none", not found)


def check_text(firmware: Firmware, text: str) -> Finding:
    """Whether the image is free of a text that bootloaders stumble over."""
    at = firmware.flash.find(text.encode("ascii"))
    return Finding(f'"{text}" in flash', f"at {at:#x}" if at >= 0 else "none", "none", at < 0)


def check_cycles(elf: Path, limit: int) -> Finding:
    """Whether a tile of an array completes an update, its links included, in time."""
    awake = cost_fit.awake(elf, DEFAULT_PERIOD_MS)
    return Finding("cycles per update", f"{awake:,.0f}", f"{limit:,}", awake <= limit, (awake, "cycles"))


def check(elf: Path, budgets: dict[str, Any]) -> list[Finding]:
    """All findings on one ELF file.

    Raises:
        OSError, ValueError: the file cannot be used.
        StackError: its stack cannot be computed.
    """
    firmware = Firmware(elf)
    program = parse(disassemble(elf))
    depth = stack.worst_case(program, budgets.get("stack", {}).get("indirect"))
    return [
        *check_sizes(firmware, depth, budgets["bytes"]),
        check_flash_data(firmware, budgets["flash"]["data_below"]),
        check_symbols(firmware, budgets["symbols"]["forbidden"]),
        check_text(firmware, budgets["flash"]["forbidden_text"]),
        check_cycles(elf, budgets["cycles"]["update"]),
    ]


def report(elf: Path, on_finding: Callable[[Finding], None] = lambda finding: None) -> int:
    """Prints the findings as a table; returns 0 if every budget holds, 1 if not, 4 if it cannot measure.

    Args:
        elf: the image.
        on_finding: called with each.
    """
    try:
        findings = check(elf, read_budgets())
    except (OSError, ValueError, TilencaError, stack.StackError, subprocess.CalledProcessError) as error:
        print(f"budgets: {error}", file=sys.stderr)
        return 4
    for finding in findings:
        on_finding(finding)
        mark = "ok" if finding.holds else "EXCEEDED"
        print(f"{finding.name:<22} {finding.measured:>14}   of {finding.limit:<8} {mark}")
    return 0 if all(finding.holds for finding in findings) else 1


def main() -> int:
    """Reports on the ELF file named on the command line."""
    parser = argparse.ArgumentParser(description="Measures the built firmware against budgets.toml.")
    parser.add_argument("elf", type=Path, help="the image, as .pio/build/megaatmega2560/firmware.elf")
    return report(parser.parse_args().elf)


if __name__ == "__main__":
    sys.exit(main())
