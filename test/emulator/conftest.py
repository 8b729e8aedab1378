"""What the tests of the emulated chip share."""

from pathlib import Path

import pytest

from support.avr import build_target
from tilenca.emulator import LIBRARY


@pytest.fixture(scope="session", autouse=True)
def library() -> Path:
    """The emulator, up to date."""
    build_target("tilenca_emulator")
    return LIBRARY
