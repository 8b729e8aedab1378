"""WebAssembly for browsers: its compiler, its types and its build, apart from all other levels.

python -m setup.web builds build/web/bundle, once `make setup-web` has been there and the firmware is built.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setup.command import ROOT, SetupError, Stamp, digest, run, say
from setup.native import configured_for

SOURCES = ROOT / "web"
BUILD = ROOT / "build" / "web"
PRESET = "web"  # of CMakePresets.json
LEAST_NODE = 20  # the first whose WebAssembly has tail calls


def system_packages() -> list[str]:
    """What Debian has to bring; a node that is there already, from wherever, is left alone."""
    missing = {"node": "nodejs", "npm": "npm"}
    wanted = [package for program, package in missing.items() if shutil.which(program) is None]
    return ["emscripten", *wanted]


def check_node(version: str) -> None:
    """Refuses a node that is too old.

    Args:
        version: what `node --version` says, such as "v20.1.0".

    Raises:
        SetupError: it is, or has no number.
    """
    found = re.match(r"v(\d+)\.", version)
    if found is None or int(found.group(1)) < LEAST_NODE:
        raise SetupError(
            f"node is {version or 'silent'}, and {LEAST_NODE} or later is needed, for the tail calls of "
            "WebAssembly; install one and run the same again"
        )


def make_ready() -> None:
    """Checks node, and installs the checker of types.

    Raises:
        SetupError: node is too old, or npm failed.
    """
    said = subprocess.run(["node", "--version"], capture_output=True, text=True, check=False)
    check_node(said.stdout.strip())
    lists = [(SOURCES / name).read_bytes() for name in ("package.json", "package-lock.json")]
    stamp = Stamp(SOURCES / "node_modules" / ".tilenca", digest(lists))
    if not stamp.is_current():
        say("installing the checker of JavaScript's types")
        run(
            ["npm", "ci", "--no-audit", "--no-fund", "--prefix", SOURCES],
            "npm failed, see above. The network is needed this once; run the same again to go on",
        )
        stamp.set()


def build() -> None:
    """Compiles the modules, and lays out the folder to serve.

    Raises:
        SetupError: emscripten is missing, or a compilation failed.
    """
    remedy = "see above; `make setup-web` installs what it needs"
    env = {
        name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")
    }
    if configured_for(BUILD) != ROOT:
        shutil.rmtree(BUILD, ignore_errors=True)
        say("compiling for WebAssembly: a minute of processor time")
        generator = ["-G", "Ninja"] if shutil.which("ninja") else ["-G", "Unix Makefiles"]
        run(["emcmake", "cmake", "--preset", PRESET, *generator], f"emcmake failed, {remedy}", env)
    jobs = ["--parallel", str(os.cpu_count() or 1)]
    run(["cmake", "--build", "--preset", PRESET, *jobs], f"WebAssembly does not compile, {remedy}", env)


def main() -> int:
    """Builds; returns the exit status."""
    try:
        build()
    except SetupError as error:
        print(f"web: {error}", file=sys.stderr)
        return 4
    print(Path("build") / "web" / "bundle")
    return 0


if __name__ == "__main__":
    sys.exit(main())
