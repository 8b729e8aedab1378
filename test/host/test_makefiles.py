"""The libraries' makefiles, wherever the clone is."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tilenca import paths


@pytest.mark.parametrize(
    ("folder", "library"),
    [
        ("tools/emulator", "build/emulator/libtilenca_emulator.so"),
        ("tools/simulator", "build/simulator/libtilenca_core.so"),
    ],
)
def test_a_clone_may_lie_in_a_folder_with_a_blank_in_its_name(
    folder: str, library: str, tmp_path: Path
) -> None:
    clone = tmp_path / "my tiles"
    for part in (folder, "firmware"):
        shutil.copytree(paths.ROOT / part, clone / part)
    done = subprocess.run(
        ["make", "-n", "-C", clone / folder], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    link = next(line for line in done.stdout.splitlines() if "-shared" in line)
    assert f"-o ../../{library}" in done.stdout
    assert "my" not in link.split(), "a path was cut at its blank"
