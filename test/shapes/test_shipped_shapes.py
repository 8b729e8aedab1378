"""The drawings that ship: each file is a task that tiles can tell apart and people can read."""

import string
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.shapes.cells import connected
from tilenca.shapes.file import Shape, Task, load_task
from tilenca.shapes.glyphs import GLYPHS

FILES = sorted(paths.SHAPES.glob("*.toml"))


def shipped(name: str) -> Task:
    return load_task(paths.SHAPES / f"{name}.toml")


def without_pose(shape: Shape) -> tuple[tuple[int, int], ...]:
    """The same cells for all eight ways to turn and mirror a drawing."""

    def at_origin(cells: list[tuple[int, int]]) -> tuple[tuple[int, int], ...]:
        top, left = min(row for row, _ in cells), min(col for _, col in cells)
        return tuple(sorted((row - top, col - left) for row, col in cells))

    poses, cells = [], list(shape.cells)
    for _ in range(4):
        cells = [(col, -row) for row, col in cells]
        poses += [at_origin(cells), at_origin([(row, -col) for row, col in cells])]
    return min(poses)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_drawing_hangs_together_and_has_no_double(path: Path) -> None:
    shapes = load_task(path).shapes
    assert all(connected(shape.cells) for shape in shapes)
    assert len({shape.rows for shape in shapes}) == len(shapes)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_label_can_be_told_from_the_others_on_the_display(path: Path) -> None:
    labels = load_task(path).labels
    assert len({GLYPHS[label] for label in labels}) == len(labels)


def test_the_hexadecimal_digits_contain_the_papers_ten() -> None:
    task = shipped("hex")
    assert "".join(task.labels).upper() == "0123456789ABCDEF"
    assert task.shapes[:10] == shipped("digits").shapes
    assert all(len(shape.rows) == 5 and len(shape.rows[0]) <= 4 for shape in task.shapes)


def test_the_pentominoes_are_the_twelve_that_there_are() -> None:
    task = shipped("pentominoes")
    assert "".join(task.labels).upper() == "FILNPTUVWXYZ"
    assert all(len(shape.cells) == 5 for shape in task.shapes)
    assert len({without_pose(shape) for shape in task.shapes}) == 12


def test_the_letters_are_the_whole_alphabet_on_five_by_five() -> None:
    task = shipped("letters")
    assert "".join(task.labels).upper() == string.ascii_uppercase
    assert all(len(shape.rows) == 5 and len(shape.rows[0]) <= 5 for shape in task.shapes)


def test_of_the_letters_only_s_and_z_look_like_digits() -> None:
    digits = {GLYPHS[digit] for digit in string.digits}
    assert [label for label in shipped("letters").labels if GLYPHS[label] in digits] == ["S", "Z"]
