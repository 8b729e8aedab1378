"""The emulator in a process of its own: that of this tree, or of a commit to measure against.

The commit is from before blocks of instructions were translated.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from tilenca.base.paths import BUILD, FIRMWARE_ELF, ROOT

COMMIT = "b005d46"
NATIVE = ROOT / "tools" / "bench" / "native_block.py"
LIBRARY = Path("build", "emulator", "libtilenca_emulator.so")

Measured = dict[str, float]


def host_of_reference(place: Path = BUILD / "reference") -> Path | None:
    """The folder of the commit's Python package, with its library compiled; None where that cannot be had."""
    tree = place / COMMIT
    if not (tree / LIBRARY).exists():
        tree.mkdir(parents=True, exist_ok=True)
        parts = ["host", "tools/emulator", "firmware/include"]
        archive = subprocess.run(
            ["git", "-C", str(ROOT), "archive", COMMIT, *parts], capture_output=True, check=False
        )
        if archive.returncode != 0:  # a clone without its history, or no clone at all
            return None
        subprocess.run(["tar", "-x", "-C", str(tree)], input=archive.stdout, check=True)
        command = ["make", "-s", "-C", str(tree / "tools" / "emulator"), f"-j{os.cpu_count() or 1}"]
        env = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
        if subprocess.run(command, capture_output=True, check=False, env=env).returncode != 0:
            return None
    return tree / "host"


def native(host: Path, case: dict[str, Any], image: Path = FIRMWARE_ELF) -> Measured:
    """What `native_block.py` measures with the package in `host`.

    Raises:
        RuntimeError: it failed; with its last line.
    """
    packages = next(Path(sys.prefix).glob("lib/python3*/site-packages"))
    # Without this environment's own tilenca, which would come first.
    env = os.environ | {"PYTHONPATH": f"{host}:{packages}"}
    return told([sys.executable, "-S", str(NATIVE), str(image), json.dumps(case)], env)


def told(command: list[str], env: dict[str, str] | None = None) -> Measured:
    """The JSON that a program prints.

    Raises:
        RuntimeError: it failed; with its last line.
    """
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=env)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip().splitlines()[-1:]}")
    measured: Measured = json.loads(done.stdout)
    return measured
