"""What the tests of training share."""

import pytest

from tilenca.base import paths
from tilenca.shapes.batch import Drawings, load_drawings

FILES = [paths.SHAPES / name for name in ("digits.toml", "digits-3x3.toml", "digits-7x6.toml")]


@pytest.fixture(scope="session")
def drawings() -> Drawings:
    """The digits at three sizes."""
    return load_drawings(FILES, 20)
