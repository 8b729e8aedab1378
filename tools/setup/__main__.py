"""The set-up after the system's own part (setup.sh): system and Python packages, C++ libraries, PlatformIO.

Run by `make setup`. Each step looks first whether it is already done, and steps that do not need each other
run side by side.
"""

import argparse
import sys
import time
from collections.abc import Sequence

from offline.seed import DEBIAN_PACKAGES
from setup import command, native, pio, python, web
from setup.command import SetupError, say
from setup.side_by_side import Awaited, side_by_side

LEVELS = {
    "demo": "build the firmware and run it on emulated tiles",
    "train": "as demo, and train models and sweep conditions",
    "test": "as train, and run the tests",
    "docs": "as train, and build the documentation site",
    "check": "as test and docs, and check format, lint, types and budgets",
    "web": "as demo, and compile for browsers",
    "fuzz": "as demo, and fuzz what parses",
}
# The levels that each one includes.
INCLUDED = {
    "train": ["demo"],
    "test": ["train"],
    "docs": ["train"],
    "check": ["test", "docs"],
    "web": ["demo"],
    "fuzz": ["demo"],
}
# Debian packages by level. The tests seed PlatformIO for real, needed here or not.
SYSTEM_PACKAGES = {
    "demo": ["g++", "make", "cmake", "ninja-build", "avrdude"],
    "test": [*DEBIAN_PACKAGES, "gdb-avr", "libelf-dev", "libsimavr-dev", *native.browser_packages()],
}
NEXT = {
    "demo": "make demo",
    "train": ". .venv/bin/activate && tilenca make my-shapes.toml (how to draw: docs/how-to/draw.md)",
    "test": "make test",
    "docs": "make docs",
    "check": "make check",
    "web": "make web",
    "fuzz": "make fuzz TIME=60",
}


def levels_up_to(level: str) -> list[str]:
    """The level and all that it includes, the smallest first."""
    below = [lower for included in INCLUDED.get(level, []) for lower in levels_up_to(included)]
    return list(dict.fromkeys([*below, level]))


def bring_up_to(levels: Sequence[str]) -> None:
    """Does the steps of the levels, three at a time.

    Raises:
        SetupError: a step failed.
        SystemExit: system packages are missing and cannot be installed; apt.sh has told the user.
    """
    compiler, system = Awaited(), Awaited()

    def packages(of: Sequence[str]) -> None:
        native.install_system_packages([name for level in of for name in SYSTEM_PACKAGES.get(level, [])])

    def install_system() -> None:
        with system:
            with compiler:
                packages(levels[:1])  # the demo's, among them the compiler
            packages(levels[1:])
            if "fuzz" in levels:
                native.install_system_packages(native.fuzz_packages())
            if "web" in levels:
                native.install_system_packages(web.system_packages())

    def compile_libraries() -> None:
        compiler.wait()
        native.build_libraries(levels)

    def install_python() -> None:
        python.make_environment(levels)
        system.wait()
        pio.make_ready()

    def install_web() -> None:
        system.wait()
        web.make_ready()

    lanes = {
        "system packages": install_system,
        "the C++ libraries": compile_libraries,
        "Python packages and PlatformIO": install_python,
    }
    side_by_side(lanes | ({"the web's packages": install_web} if "web" in levels else {}))


def main() -> int:
    """Brings the clone up to the wanted level; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="setup",
        description="Makes this clone ready to use.",
        epilog="Levels: " + "; ".join(f"{name}: {purpose}" for name, purpose in LEVELS.items()) + ".",
    )
    parser.add_argument("level", nargs="?", choices=list(LEVELS), default="demo")
    parser.add_argument("--next", action="store_true", help="say at the end which command is next")
    args = parser.parse_args()
    started = time.monotonic()
    try:
        bring_up_to(levels_up_to(args.level))
    except SetupError as error:
        print(f"setup: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("setup: interrupted; run it again to go on", file=sys.stderr)
        return 130
    if args.next:
        say(f"ready. Next: {NEXT[args.level]}")
    elif command.has_said_something():
        say(f"ready after {time.monotonic() - started:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
