"""Builds the fuzz targets: with clang for libFuzzer, or with any compiler to give them files."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
CORPUS = ROOT / "test" / "fuzz" / "corpus"
FUZZ = ROOT / "tools" / "fuzz"
FIRMWARE = ROOT / "firmware"
EMULATOR = ROOT / "tools" / "emulator" / "src"
C_API = (ROOT / "tools", ROOT / "tools" / "c_api" / "include", ROOT / "tools" / "emulator" / "include")
FLAGS = ("-std=c++17", "-O1", "-g", "-fno-sanitize-recover=all")


@dataclass(frozen=True)
class Suite:
    """Targets that are built into one program.

    Attributes:
        name: of the program.
        targets: their names.
        parts: its files beside this one, without their ending.
        includes: where its headers are.
        emulator: whether it needs the emulator; the others need what of the firmware knows no chip.
    """

    name: str
    targets: tuple[str, ...]
    parts: tuple[str, ...]
    includes: tuple[Path, ...]
    emulator: bool = False

    def sources(self) -> list[Path]:
        """All that is compiled with it; the emulator is linked."""
        rooms = () if self.emulator else ("core", "app", "model")
        parts = [path for room in rooms for path in (FIRMWARE / "src" / room).glob("*.cpp")]
        return [*(FUZZ / f"{part}.cpp" for part in self.parts), *sorted(parts)]


SUITES = (
    Suite("firmware", ("frames", "commands", "settings"), ("firmware",), (FIRMWARE / "include", FUZZ)),
    Suite(
        "emulator",
        ("snapshots", "images", "calls"),
        ("emulator", "base_array", "calls"),
        (FIRMWARE / "include", FUZZ, EMULATOR, *C_API),
        emulator=True,
    ),
)
TARGETS = tuple(target for suite in SUITES for target in suite.targets)


def suite_of(target: str) -> Suite:
    """The suite that has a target."""
    return next(suite for suite in SUITES if target in suite.targets)


def emulator_library(compiler: str, folder: Path, *options: str) -> Path:
    """The emulator as a static library, built with the same options into a folder of its own.

    Raises:
        CalledProcessError: it does not build; CMake or the compiler has said why.
        FileNotFoundError: there is no CMake.
    """
    flags = f"-DCMAKE_CXX_FLAGS={' '.join(options)} -fno-sanitize-recover=all -fno-omit-frame-pointer"
    kind = ["-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g", f"-DCMAKE_CXX_COMPILER={compiler}"]
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), *kind, flags]
    make = ["cmake", "--build", str(folder), "--target", "emulator_inside", "--parallel"]
    for command in (configure, make):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder / "libtilenca_emulator_inside.a"


def build(
    compiler: str, suite: Suite, main: str, program: Path, *options: str, library: Path | None = None
) -> None:
    """Builds a program of a suite's targets and one of the files beside this one.

    Args:
        compiler: of C++.
        suite: what the program has.
        main: the file with the entry point.
        program: where it goes.
        options: of the compiler, beside those that all have.
        library: the emulator, if the suite needs it.

    Raises:
        CalledProcessError: it does not build; the compiler has said why.
        FileNotFoundError: there is no such compiler.
    """
    includes = [word for folder in suite.includes for word in ("-I", folder)]
    command = [compiler, *FLAGS, *options, *includes, FUZZ / main, *suite.sources()]
    if library is not None:
        command += [library, "-pthread", "-ldl"]
    program.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([*map(str, command), "-o", str(program)], check=True)
