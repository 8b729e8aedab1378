"""A single tile of a lab."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from support.lab import Lab


@pytest.fixture
def lone_tile(firmware: Path, tmp_path: Path) -> Iterator[Lab]:
    """A lab of one tile, for what needs no other: nineteen that only wait take a processor's time, too."""
    with Lab(firmware, tmp_path, ["#"]) as lab:
        yield lab
