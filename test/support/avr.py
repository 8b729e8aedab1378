"""Fixtures of the emulator's tests: AVR programs compiled on the spot, and what they run on."""

import fcntl
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

from support.alone import alone
from support.conversation import Talk
from tilenca.base.paths import BUILD, FIRMWARE_ELF
from tilenca.emulator import IDEAL, Array
from tilenca.protocol.settings import settings_block

ROOT = Path(__file__).resolve().parents[2]
# What tests have compiled and others may use again, by its content.
BUILT = BUILD / "test"

Compile = Callable[..., Path]


class IdealArray(Array):
    """Chips on ideal boards, for tests of the chip: inputs that nobody drives read high, SRAM is empty."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **{"hardware": IDEAL, **options})


def run_tool(*command: str | Path) -> str:
    """What a program prints; fails the test with its errors if it does not succeed."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{command[0]} failed:\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture
def talk() -> Iterator[Talk]:
    """A lone tile that has an id and a period, past its greeting."""
    with Array(FIRMWARE_ELF) as array:
        array[0].write_eeprom(0, settings_block(7, 100, 0))
        talk = Talk(array)
        talk.listen(0.7)
        yield talk


def hex_record(kind: int, address: int, data: bytes) -> str:
    """A line of an Intel HEX file."""
    body = bytes([len(data), address >> 8 & 0xFF, address & 0xFF, kind]) + data
    return f":{(body + bytes([-sum(body) & 0xFF])).hex().upper()}\n"


def build_target(name: str) -> None:
    """Brings a target of the C++ release build up to date; tests in other processes wait meanwhile."""
    build = ROOT / "build" / "release"
    with (build / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        run_tool("cmake", "--build", build, "--target", name)


# Below -O2 g++ ignores types where it links, and joins functions that are alike but for a type; the code of
# the library counts on types (-fstrict-aliasing), so that such a program goes wrong.
INSIDE_OPTIONS = ("-O2",)


def build_inside() -> Path:
    """The release build's emulator as a static library; what links it needs `INSIDE_OPTIONS`."""
    build_target("emulator_inside")
    return ROOT / "build" / "release" / "libtilenca_emulator_inside.a"


def compile_differential(directory: Path) -> Path:
    """The program that runs our core and libsimavr side by side, and looks inside both."""
    inside = build_inside()
    program, source = directory / "differential", ROOT / "test" / "emulator" / "differential.cpp"
    search = ("-I", ROOT / "tools" / "emulator" / "src", "-I", ROOT / "firmware" / "include")
    links = (inside, "-pthread", "-lsimavr", "-lelf")
    run_tool("g++", "-std=c++17", *INSIDE_OPTIONS, *search, source, "-o", program, *links)
    return program


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


ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
MEGA = (
    "-mmcu=atmega2560",
    "-DF_CPU=16000000UL",
    "-DARDUINO=10807",
    "-DARDUINO_AVR_MEGA2560",
    "-DARDUINO_ARCH_AVR",
)
FOR_SIZE = ("-Os", "-w", "-ffunction-sections", "-fdata-sections", "-DDECIMAL_DIG=__DECIMAL_DIG__")
INCLUDES = ("-I", ARDUINO / "cores" / "arduino", "-I", ARDUINO / "variants" / "mega")
LANGUAGES = {
    ".c": ("-std=gnu11",),
    ".cpp": ("-std=gnu++11", "-fno-exceptions", "-fpermissive", "-fno-threadsafe-statics"),
    ".S": ("-x", "assembler-with-cpp"),
}
# A function defined at the outer level of a sketch; the Arduino IDE declares them all before the first.
DEFINITION = re.compile(r"^((?:unsigned )?[a-z_]\w*[ *]+\w+\([^;{}()]*\))\s*\{", re.MULTILINE)


def _compile_arduino(source: Path, target: Path, *options: str | Path) -> Path:
    compiler = "avr-g++" if source.suffix == ".cpp" else "avr-gcc"
    flags = (*MEGA, *FOR_SIZE, *LANGUAGES[source.suffix], *INCLUDES, *options)
    run_tool(compiler, *flags, "-c", source, "-o", target)
    return target


@pytest.fixture(scope="session")
def arduino_core() -> Path:
    """Arduino's core for the Mega, compiled once for all processes that run tests."""
    if not ARDUINO.exists() or shutil.which("avr-gcc") is None:
        pytest.skip("arduino-core-avr is not installed; run `make setup`")
    core = ARDUINO / "cores" / "arduino"
    files = sorted(file for file in core.iterdir() if file.is_file())
    sources = [file for file in files if file.suffix in LANGUAGES]
    directory = BUILT / f"arduino-{_digest(MEGA, FOR_SIZE, LANGUAGES, *files)}"
    archive = directory / "core.a"
    with alone("arduino"):
        if not archive.exists():
            directory.mkdir(parents=True, exist_ok=True)
            with ThreadPoolExecutor(2) as pool:
                objects = list(
                    pool.map(lambda one: _compile_arduino(one, directory / f"{one.name}.o"), sources)
                )
            run_tool("avr-ar", "rcs", directory / "core.part", *objects)
            (directory / "core.part").rename(archive)
    return archive


@cache
def _compiler() -> str:
    return run_tool("avr-gcc", "--version")


def _digest(*parts: object) -> str:
    """Names a program by all that it is made of: files by their content, all else by its text."""
    digest = sha256(_compiler().encode())
    for part in parts:
        digest.update(part.read_bytes() if isinstance(part, Path) else repr(part).encode())
        digest.update(b"\0")
    return digest.hexdigest()[:16]


@pytest.fixture
def arduino(arduino_core: Path, tmp_path: Path) -> Compile:
    """Compiles a sketch, given as text or as an .ino file, with Arduino libraries; returns the ELF file."""

    def compile_sketch(sketch: str | Path, *libraries: str) -> Path:
        text = sketch.read_text() if isinstance(sketch, Path) else sketch
        declarations = "".join(f"{definition};\n" for definition in DEFINITION.findall(text))
        first = DEFINITION.search(text)
        start = first.start() if first else 0
        main = tmp_path / "sketch.cpp"
        main.write_text("#include <Arduino.h>\n" + text[:start] + declarations + text[start:])
        folders = [ARDUINO / "libraries" / library / "src" for library in libraries]
        search = [word for folder in folders for word in ("-I", folder, "-I", folder / "utility")]
        sources = [main]
        for folder in folders:
            sources += [one for one in sorted(folder.rglob("*")) if one.suffix in LANGUAGES]
        objects = [_compile_arduino(one, tmp_path / f"{one.name}.o", *search) for one in sources]
        elf = tmp_path / "sketch.elf"
        run_tool(
            "avr-gcc",
            "-mmcu=atmega2560",
            "-Os",
            "-Wl,--gc-sections",
            *objects,
            arduino_core,
            "-lm",
            "-o",
            elf,
        )
        return elf

    return compile_sketch


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
