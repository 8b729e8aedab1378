"""What sees a whole drawing: it finds what it knows, and what is like it."""

import sys
from pathlib import Path

import numpy as np
import pytest

from bench import whole
from tilenca.base import paths
from tilenca.shapes.file import Shape


def test_a_drawing_is_stretched_to_one_size() -> None:
    image = whole.stretched(Shape("1", ("#.", "##"), "1"))
    assert image.shape == (whole.HEIGHT, whole.WIDTH)
    assert image[:8, :6].all()
    assert not image[:8, 6:].any()
    assert image[8:].all()


def test_both_find_what_they_know() -> None:
    known, labels = whole.read(paths.SHAPES / "digits.toml")
    assert list(whole.by_neighbours(known, labels, known, 1)) == list(labels)
    many = np.repeat(known, 40, axis=0)
    assert list(whole.by_convolutions(many, np.repeat(labels, 40), known, 1)) == list(labels)


def test_the_commonest_of_the_nearest_counts() -> None:
    images = np.zeros((4, 1, 3), np.float32)
    images[1:, 0, 0] = 1
    images[3, 0, 1:] = 1
    labels = np.array(["a", "b", "b", "c"])
    assert list(whole.by_neighbours(images, labels, images[:1], 1)) == ["a"]
    assert list(whole.by_neighbours(images, labels, images[:1], 3)) == ["b"]


def test_a_file_that_is_none_is_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "argv", ["whole", str(tmp_path / "none.toml"), str(tmp_path / "none.toml")])
    assert whole.main() == 1
