"""Builds the fuzz targets: with clang for libFuzzer, or with any compiler to give them files."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
CORPUS = ROOT / "test" / "fuzz" / "corpus"
TARGETS = ("frames", "commands", "settings")
FIRMWARE = ROOT / "firmware"
FLAGS = ("-std=c++17", "-O1", "-g", "-fno-sanitize-recover=all")


def sources() -> list[Path]:
    """The parts of the firmware that know no chip, and the targets."""
    parts = [path for room in ("core", "app", "model") for path in (FIRMWARE / "src" / room).glob("*.cpp")]
    return [ROOT / "tools" / "fuzz" / "targets.cpp", *sorted(parts)]


def build(compiler: str, main: str, program: Path, *options: str) -> None:
    """Builds a program of the targets and one of the files beside this one.

    Raises:
        CalledProcessError: it does not build; the compiler has said why.
        FileNotFoundError: there is no such compiler.
    """
    includes = ["-I", FIRMWARE / "include", "-I", ROOT / "tools" / "fuzz"]
    command = [compiler, *FLAGS, *options, *includes, ROOT / "tools" / "fuzz" / main, *sources()]
    program.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([*map(str, command), "-o", str(program)], check=True)
