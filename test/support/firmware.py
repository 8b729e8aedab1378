"""What the tests of the host's side share."""

import shutil
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
