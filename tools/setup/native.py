"""The parts outside Python: system packages and the C++ libraries."""

import os
import subprocess
from collections.abc import Sequence

from setup.command import ROOT, run, say

# By the level of the set-up that needs them.
LIBRARIES = {
    "demo": {
        "tools/emulator": "build/emulator/libtilenca_emulator.so",
        "tools/simulator": "build/simulator/libtilenca_core.so",
    },
    "train": {"tools/training": "build/training/libtilenca_life.so"},
}


def install_system_packages(packages: Sequence[str]) -> None:
    """Installs those of the packages that are missing, by apt.

    Raises:
        SystemExit: they cannot be installed; apt.sh has told the user the reason and the remedy.
    """
    if not packages:
        return
    done = subprocess.run(
        ["sh", "tools/setup/apt.sh", *packages], cwd=ROOT, stdin=subprocess.DEVNULL, check=False
    )
    if done.returncode:
        raise SystemExit(done.returncode)


def build_libraries(levels: Sequence[str]) -> None:
    """Compiles what the levels need for this machine; make knows what is up to date.

    Raises:
        SetupError: a compilation failed.
    """
    # The makes run on their own: flags and the job server of a make that called us are not meant for them.
    env = {
        name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")
    }
    jobs = f"-j{os.cpu_count() or 1}"
    wanted = {folder: library for level in levels for folder, library in LIBRARIES.get(level, {}).items()}
    for folder, library in wanted.items():
        if not (ROOT / library).exists():
            say(f"compiling {folder}")
        run(["make", "--silent", jobs, "-C", folder], f"{folder} does not compile, see above", env=env)
