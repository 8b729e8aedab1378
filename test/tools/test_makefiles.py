"""The libraries' makefiles, wherever the clone is."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from support.alone import alone
from tilenca.base import paths

PIO = Path(sys.executable).with_name("pio")


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


@pytest.mark.skipif(not PIO.exists(), reason="PlatformIO is not installed; run `make setup`")
def test_the_core_builds_for_this_machine_without_its_tests() -> None:
    command = [str(PIO), "run", "-s", "-d", str(paths.ROOT), "-e", "native"]
    with alone("pio"):
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
