"""The parts outside Python: system packages and the C++ libraries."""

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from setup.command import ROOT, run, say

BUILD = ROOT / "build" / "release"
PRESET = "release"  # of CMakePresets.json

# Targets of CMake, by the level of the set-up that needs them.
LIBRARIES = {"demo": ["tilenca_emulator", "tilenca_simulator"], "train": ["tilenca_rollout"]}
REMEDY = "see above; where it is not the code's fault, remove build/release and run the same again"


def browser_packages(os_release: Path = Path("/etc/os-release")) -> list[str]:
    """The packages of a browser for the page's tests, with a font; none where apt has no such package.

    Ubuntu has Chromium as a snap only. Where there is none, those tests are skipped and say so.
    """
    try:
        told = os_release.read_text(encoding="utf-8")
    except OSError:
        return []
    is_debian = re.search(r'^ID="?debian"?$', told, re.MULTILINE) is not None
    return ["chromium", "fonts-dejavu-core"] if is_debian else []


def fuzz_packages() -> list[str]:
    """Debian's clang, and the libraries of its sanitizers and fuzzer, whose name has its version."""
    depends = ["apt-cache", "depends", "clang"]
    try:
        told = subprocess.run(depends, capture_output=True, text=True, check=False).stdout
    except OSError:
        return ["clang"]
    found = re.search(r"\bclang-(\d+)\b", told)
    return ["clang", *([f"libclang-rt-{found[1]}-dev"] if found else [])]


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
    """Compiles what the levels need for this machine; CMake knows what is up to date.

    Raises:
        SetupError: CMake is missing, or a compilation failed.
    """
    # The build runs on its own: flags and the job server of a make that called us are not meant for it.
    env = {
        name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")
    }
    cache = BUILD / "CMakeCache.txt"
    if configured_for(BUILD) != ROOT:
        shutil.rmtree(BUILD, ignore_errors=True)
        say("compiling the C++ libraries")
    if not cache.exists() or cache.stat().st_mtime < (ROOT / "CMakePresets.json").stat().st_mtime:
        ninja = shutil.which("ninja") is not None and not (BUILD / "Makefile").exists()
        generator = ["-G", "Ninja"] if ninja else []
        run(
            ["cmake", "--preset", PRESET, *generator],
            f"CMake cannot prepare the libraries, {REMEDY}",
            env,
        )
        cache.touch()  # CMake leaves it alone where nothing in it changes
    wanted = [target for level in levels for target in LIBRARIES.get(level, [])]
    jobs = ["--parallel", str(os.cpu_count() or 1)]
    build = ["cmake", "--build", "--preset", PRESET, *jobs, "--target", *wanted]
    run(build, f"the C++ libraries do not compile, {REMEDY}", env)


def configured_for(build: Path) -> Path | None:
    """The source tree that a build folder of CMake is for; None: it is not ready to build in.

    A clone that was moved takes its build folder along, which is of no use at the new place.
    """
    if not any((build / name).exists() for name in ("build.ninja", "Makefile")):
        return None
    try:
        cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
    found = re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)$", cache, re.MULTILINE)
    return Path(found.group(1)) if found else None
