"""What the tests of the host's side share."""

import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from support.alone import alone
from tilenca.base import paths
from tilenca.fleet.build import build


@pytest.fixture(scope="session")
def firmware(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The firmware as `tilenca flash` builds it: a copy of the ELF, and of the HEX beside it."""
    folder = tmp_path_factory.mktemp("firmware")
    with alone("pio"):
        build()
        for suffix in (".elf", ".hex"):
            shutil.copy(paths.FIRMWARE_ELF.with_suffix(suffix), folder)
    return folder / paths.FIRMWARE_ELF.name


@cache
def board_test_image() -> Path:
    """The image of the environment `board_test`, built as users build it."""
    pio = str(Path(sys.executable).with_name("pio"))
    with alone("pio"):
        subprocess.run([pio, "run", "-s", "-d", str(paths.ROOT), "-e", "board_test"], check=True)
    return paths.ROOT / ".pio" / "build" / "board_test" / "firmware.elf"
