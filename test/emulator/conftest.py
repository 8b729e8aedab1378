"""What the tests of the emulated chip share."""

from pathlib import Path

import pytest

from support.alone import alone
from support.avr import ROOT, run_tool
from tilenca.emulator import LIBRARY


@pytest.fixture(scope="session", autouse=True)
def library() -> Path:
    """The emulator, up to date."""
    with alone("emulator"):
        run_tool("make", "-C", ROOT / "tools" / "emulator")
    return LIBRARY
