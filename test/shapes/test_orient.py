"""Drawings turned and mirrored."""

from pathlib import Path

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.shapes.file import load_task
from tilenca.shapes.orient import orientations, orientations_of_skeleton
from tilenca.shapes.skeleton import of_rows

L = ("#.", "#.", "##")


def shape(label: str, rows: tuple[str, ...]) -> str:
    return '\n[[shape]]\nlabel = "{}"\ngrid = """\n{}\n"""\n'.format(label, "\n".join(rows))


def write(folder: Path, text: str) -> Path:
    file = folder / "mine.toml"
    file.write_text(text)
    return file


@pytest.mark.parametrize(
    ("rows", "turned", "every"),
    [(L, 4, 8), (("##", "##"), 1, 1), (("###",), 2, 2), ((".##", "##."), 2, 4), (("###", ".#."), 4, 4)],
)
def test_each_orientation_is_there_once(rows: tuple[str, ...], turned: int, every: int) -> None:
    assert orientations(rows, None) == [rows]
    assert len(set(orientations(rows, "turned"))) == len(orientations(rows, "turned")) == turned
    assert len(set(orientations(rows, "all"))) == every


def test_a_quarter_turn_is_clockwise() -> None:
    assert orientations(L, "turned")[1] == ("###", "#..")


def test_a_skeleton_turns_as_its_drawing_does() -> None:
    skeleton = of_rows(("#..", "#..", "###"))
    half = skeleton.points / 2
    (first, second, *_) = orientations_of_skeleton(
        type(skeleton)(half, skeleton.edges, skeleton.fills), "turned"
    )
    drawn = of_rows(orientations(("#..", "#..", "###"), "turned")[1])
    assert np.array_equal(first.points, half)
    assert {tuple(point) for point in second.points} == {tuple(point) for point in drawn.points / 2}


def test_a_file_gets_all_orientations_under_its_labels(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, 'orientations = "turned"\n' + shape("L", L) + shape("0", ("##", "##"))))
    assert [s.name for s in task.shapes] == ["L", "0", "L@2", "L@3", "L@4"]
    both = 'orientations = "all"\n' + shape("L", L) + shape("L", L[::-1])
    assert len(load_task(write(tmp_path, both)).shapes) == 8


def test_the_pentominoes_are_the_sixty_three() -> None:
    task = load_task(paths.DEFAULT_SHAPES.parent / "pentominoes.toml")
    assert (len(task.shapes), len(task.labels)) == (63, 12)


@pytest.mark.parametrize(
    ("kind", "rows", "how"),
    [
        ("turned", ("##", ".#", ".#"), "turned"),
        ("all", (".#", ".#", "##"), "turned or mirrored"),
    ],
)
def test_classes_that_become_one_another_are_refused(
    tmp_path: Path, kind: str, rows: tuple[str, ...], how: str
) -> None:
    file = write(tmp_path, f'orientations = "{kind}"\n' + shape("L", L) + shape("7", rows))
    with pytest.raises(UsageError, match=f"'7' {how} is 'L'; leave one of them out"):
        load_task(file)


def test_digits_that_may_be_turned_are_refused_for_six_and_nine(tmp_path: Path) -> None:
    text = paths.DEFAULT_SHAPES.read_text()
    with pytest.raises(UsageError, match=r"'(6|9)' turned is '(9|6)'"):
        load_task(write(tmp_path, 'orientations = "turned"\n' + text))


def test_no_other_kind_is_known(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match='"turned" or "all"'):
        load_task(write(tmp_path, 'orientations = "upside down"\n' + shape("L", L)))
