"""Drawings of several files together, and laid on one another."""

from pathlib import Path

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.shapes.batch import Drawings, load_drawings, load_training_task

FILES = [paths.SHAPES / name for name in ("digits.toml", "digits-3x3.toml", "digits-7x6.toml")]


@pytest.fixture(scope="module")
def drawings() -> Drawings:
    return load_drawings(FILES, 20)


def test_every_drawing_laid_on_another_keeps_tiles_at_their_places(drawings: Drawings) -> None:
    random = np.random.default_rng(5)
    one, four = (next(n for n, s in enumerate(drawings.shapes) if s.name == name) for name in "14")
    columns = {
        drawings.shapes[four].cells[i]
        for _ in range(200)
        for i in drawings.overlap(one, four, random)
        if i >= 0
    }
    assert columns  # a "1" may have stood on several columns of the "4"
    stays = drawings.overlap(four, one, random)
    assert len(stays) == 5
    assert (stays >= 0).sum() >= 1
    same = drawings.overlap(four, four, random)
    assert same.tolist() == list(range(len(same)))


def test_a_drawing_with_two_labels_in_two_files_is_refused(tmp_path: Path) -> None:
    first, second = tmp_path / "a.toml", tmp_path / "b.toml"
    first.write_text('[[shape]]\nlabel = "1"\ngrid = """\n##\n"""\n')
    second.write_text('[[shape]]\nlabel = "2"\ngrid = """\n##\n"""\n')
    with pytest.raises(UsageError, match=r"b\.toml: '2' is drawn exactly like '1' of .*a\.toml"):
        load_drawings([first, second])


def test_too_many_classes_over_all_files_are_refused(tmp_path: Path) -> None:
    first, second = tmp_path / "a.toml", tmp_path / "b.toml"
    first.write_text('[[shape]]\nlabel = "1"\ngrid = """\n##\n"""\n')
    second.write_text('[[shape]]\nlabel = "2"\ngrid = """\n###\n"""\n')
    with pytest.raises(UsageError, match="2 classes in all files, but the model's state has room for 1"):
        load_drawings([first, second], max_classes=1)


def test_drawings_of_one_label_share_a_class() -> None:
    drawings: Drawings = load_drawings([paths.SHAPES / "digits-3x3.toml"], labels="0123456789")
    sevens = [n for n, shape in enumerate(drawings.shapes) if shape.label == "7"]
    assert drawings.classes[sevens].tolist() == [7, 7]


def test_files_that_tables_could_not_tell_apart_are_refused(tmp_path: Path) -> None:
    shapes = tmp_path / "digits.toml"
    shapes.write_text('[[shape]]\nlabel = "1"\ngrid = "#"\n')
    with pytest.raises(UsageError, match="another file has that name"):
        load_drawings([paths.DEFAULT_SHAPES, shapes])
    with pytest.raises(UsageError, match="all of its drawings"):
        load_drawings([shapes, shapes])


def test_a_large_area_has_no_strokes_to_vary(tmp_path: Path) -> None:
    file = tmp_path / "areas.toml"
    for side, strokes in ((4, True), (15, False)):
        block = "\n".join(["#" * side] * side)
        file.write_text(f'[[shape]]\nlabel = "0"\ngrid = """\n{block}\n"""\n')
        assert (load_training_task([file], 1.0, 20)[0].variants is not None) == strokes
