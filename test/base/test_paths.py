"""What ships is where the paths say."""

import os
import subprocess
import sys
from pathlib import Path

from tilenca.base import paths


def test_what_ships_is_there() -> None:
    assert paths.DEFAULT_SHAPES.is_file()
    assert (paths.DEFAULT_MODEL / "model.json").is_file()
    assert (paths.FIRMWARE / "src" / "main.cpp").is_file()


def test_the_firmwares_environment_is_one_of_platformio_ini() -> None:
    assert f"[env:{paths.FIRMWARE_ENV}]" in (paths.ROOT / "platformio.ini").read_text(encoding="utf-8")
    assert paths.FIRMWARE_ELF.parent.name == paths.FIRMWARE_ENV


def test_the_folder_one_stands_in_does_not_count(tmp_path: Path) -> None:
    program = "from tilenca.base import paths; print(paths.DEFAULT_SHAPES)"
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=os.environ,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == str(paths.DEFAULT_SHAPES)
