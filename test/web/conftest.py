"""What the tests of the WebAssembly build share. They are skipped where that is not built."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tilenca.base import paths

SOURCES = paths.ROOT / "web"
BUNDLE = paths.BUILD / "web" / "bundle"
LEAST_NODE = 20
PATIENCE_S = 300


def missing() -> str:
    """Why nothing of it can run here; "": it can."""
    modules = [BUNDLE / f"tilenca_{name}.wasm" for name in ("emulator", "simulator")]
    if not all(module.exists() for module in modules):
        return f"{BUNDLE} is not built; run `make test-web`"
    node = shutil.which("node")
    if node is None:
        return "node is not installed; run `make test-web`"
    version = subprocess.run([node, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    if int(version.removeprefix("v").split(".")[0]) < LEAST_NODE:
        return f"node is {version}, and {LEAST_NODE} or later is needed"
    return ""


def node(*arguments: str | Path) -> str:
    """What a program for node prints.

    Raises:
        AssertionError: it failed; with what it said.
    """
    done = subprocess.run(
        ["node", *map(str, arguments)], capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="session")
def bundle() -> Path:
    """The folder that is built to be served."""
    if reason := missing():
        pytest.skip(reason)
    return BUNDLE
