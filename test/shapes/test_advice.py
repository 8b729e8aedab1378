"""What a shape file is told about before a training."""

from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.shapes.advice import CLEAR, HINTS, advice, overlap
from tilenca.shapes.file import load_task
from tilenca.shapes.glyphs import GLYPHS

L, U, T = ("#..", "#..", "###"), ("#.#", "#.#", "###"), ("###", ".#.", ".#.")


def told(folder: Path, **drawings: tuple[str, ...]) -> list[str]:
    file = folder / "mine.toml"
    tables = (
        f'[[shape]]\nlabel = "{label[0]}"\ngrid = """\n' + "\n".join(rows) + '\n"""\n'
        for label, rows in drawings.items()
    )
    file.write_text("".join(tables), encoding="utf-8")
    return list(advice(load_task(file)))


def test_drawings_are_laid_upon_each_other_in_every_place() -> None:
    assert overlap(L, L) == 5
    assert overlap(L, U) == overlap(U, L) == 5
    assert overlap(("#",), ("....#",)) == 1
    assert overlap(("###",), ("#", "#", "#")) == 1


def test_what_is_a_part_of_what_is_told_and_what_a_tile_tells_apart(tmp_path: Path) -> None:
    part, _ = told(tmp_path, L=L, U=U)
    assert part.endswith(": L of U")
    apart, _ = told(tmp_path, L=L, U=("##.", "#..", "###"))
    assert apart.startswith("one tile makes the difference between L and U: ")
    assert len(told(tmp_path, L=L, P=("#####",), E=("##", "##"))) == 1, "these have nothing in common"


def test_drawings_of_one_class_may_be_as_alike_as_they_like(tmp_path: Path) -> None:
    assert len(told(tmp_path, L1=L, L2=("#...", "#...", "####"))) == 1


def test_labels_that_a_display_only_hints_at_are_told_with_what_they_look_like(tmp_path: Path) -> None:
    first, *_ = told(tmp_path, X=T, L=L)
    assert first.startswith("a 7-segment digit can only hint at X (looks like H); clear are ")
    assert not any("hint" in sentence for sentence in told(tmp_path, t=T, L=L))


def test_clear_labels_can_be_shown_and_are_no_hints() -> None:
    clear = CLEAR.split()
    assert set(clear) <= GLYPHS.keys()
    assert not set(clear) & HINTS.keys()
    assert {other for other in HINTS.values() if other} <= GLYPHS.keys()


@pytest.mark.parametrize(("name", "words"), [("digits", "from 5x3 to "), ("letters", "has no [sizes]")])
def test_sizes_are_those_of_the_file(name: str, words: str) -> None:
    assert words in list(advice(load_task(paths.SHAPES / f"{name}.toml")))[-1]


def test_the_digits_differ_by_a_tile_where_people_know_it() -> None:
    (apart,) = (text for text in advice(load_task(paths.DEFAULT_SHAPES)) if text.startswith("one tile"))
    assert "6 and 8" in apart
    assert "1 and 0" not in apart
