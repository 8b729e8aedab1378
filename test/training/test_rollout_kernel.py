"""The rollout's inner loop, compiled."""

from pathlib import Path

import pytest

from tilenca.base.errors import BuildError
from tilenca.training.rollout_kernel import library


def test_a_library_that_is_missing_or_damaged_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(BuildError, match="not built yet; run: make setup-train"):
        library(tmp_path / "nothing.so")
    (tmp_path / "damaged.so").write_bytes(b"not a library")
    with pytest.raises(BuildError, match=r"not usable .*; remove it and run: make setup-train"):
        library(tmp_path / "damaged.so")
