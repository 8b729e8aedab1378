"""The set-up after the system's own part (setup.sh): Python packages, C++ libraries, PlatformIO.

Run by `make setup`; each step looks first whether it is already done.
"""

import argparse
import sys

from offline.seed import DEBIAN_PACKAGES
from setup import native, pio, python
from setup.command import SetupError

LEVELS = {
    "demo": "build the firmware and run it on emulated tiles",
    "train": "as demo, and train models",
    "test": "as train, and run the tests",
    "docs": "as train, and build the documentation site",
    "check": "as test and docs, and check format, lint, types and budgets",
}
# The levels that each one includes.
INCLUDED = {"train": ["demo"], "test": ["train"], "docs": ["train"], "check": ["test", "docs"]}
# Debian packages beyond those of setup.sh. The tests seed PlatformIO for real, needed here or not.
SYSTEM_PACKAGES = {"test": [*DEBIAN_PACKAGES, "gdb-avr", "libelf-dev", "libsimavr-dev"]}


def levels_up_to(level: str) -> list[str]:
    """The level and all that it includes, the smallest first."""
    below = [lower for included in INCLUDED.get(level, []) for lower in levels_up_to(included)]
    return list(dict.fromkeys([*below, level]))


def main() -> int:
    """Brings the clone up to the wanted level; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="setup",
        description="Makes this clone ready to use.",
        epilog="Levels: " + "; ".join(f"{name}: {purpose}" for name, purpose in LEVELS.items()) + ".",
    )
    parser.add_argument("level", nargs="?", choices=list(LEVELS), default="demo")
    reached = levels_up_to(parser.parse_args().level)
    try:
        native.install_system_packages([name for step in reached for name in SYSTEM_PACKAGES.get(step, [])])
        python.make_environment(reached)
        native.build_libraries(reached)
        pio.make_ready()
    except SetupError as error:
        print(f"setup: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("setup: interrupted; run it again to go on", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
