"""Fixtures of the emulator's tests: AVR programs compiled on the spot, and what they run on."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tilenca.emulator import LIBRARY

ROOT = Path(__file__).resolve().parents[2]

Compile = Callable[..., Path]


def run_tool(*command: str | Path) -> str:
    """What a program prints; fails the test with its errors if it does not succeed."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{command[0]} failed:\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="session", autouse=True)
def library() -> Path:
    """The emulator, up to date."""
    run_tool("make", "-C", ROOT / "tools" / "emulator")
    return LIBRARY


@pytest.fixture
def avr(tmp_path: Path) -> Compile:
    """Compiles C for the ATmega2560 and returns the ELF file."""
    if shutil.which("avr-gcc") is None:
        pytest.skip("avr-gcc is not installed; run `make setup`")

    def compile_program(source: str, *options: str, mcu: str = "atmega2560") -> Path:
        text, elf = tmp_path / "program.c", tmp_path / "program.elf"
        text.write_text(PRELUDE + source)
        flags = (f"-mmcu={mcu}", "-DF_CPU=16000000UL", "-Os", "-std=gnu11", "-Wall", "-Werror")
        run_tool("avr-gcc", *flags, *options, text, "-o", elf)
        return elf

    return compile_program


# What most programs need: `result` is where they leave what the test looks at, at a fixed place in SRAM.
PRELUDE = """
#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdint.h>
#include <util/delay.h>
#define result ((volatile uint8_t *)0x1000)
#define result16 ((volatile uint16_t *)0x1000)
"""


def words(memory: bytes) -> list[int]:
    """Little-endian 16-bit words."""
    return [low | high << 8 for low, high in zip(memory[::2], memory[1::2], strict=True)]
