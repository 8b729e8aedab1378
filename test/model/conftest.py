"""What the tests of model files share."""

import shutil
from pathlib import Path

import pytest

from tilenca.base import paths


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A copy of the shipped model."""
    return Path(shutil.copytree(paths.DEFAULT_MODEL, tmp_path / "model"))
