"""The tests of the JavaScript face, which node runs, and the types, which TypeScript checks."""

import subprocess
from pathlib import Path

import pytest

from web.conftest import SOURCES, node

COMPILER = SOURCES / "node_modules" / "typescript" / "bin" / "tsc"
FILES = sorted((SOURCES / "test").glob("*.test.js"))


def test_there_are_tests_for_node() -> None:
    assert len(FILES) >= 4


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_the_face(bundle: Path, file: Path) -> None:
    said = node("--test", file)
    assert "\n# fail 0\n" in said
    assert "\n# pass 0\n" not in said


def test_types_are_right() -> None:
    if not COMPILER.exists():
        pytest.skip(f"{COMPILER} is not installed; run `make test-web`")
    done = subprocess.run(
        ["node", COMPILER, "--project", SOURCES], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stdout
