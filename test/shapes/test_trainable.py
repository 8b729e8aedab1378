"""Which drawings can be trained."""

from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import load_task
from tilenca.shapes.trainable import extent, refuse_collisions, refuse_large_sizes, trainable


def test_the_shipped_files_are_trainable_at_all_their_sizes() -> None:
    for path in sorted(paths.SHAPES.glob("*.toml")):
        task = trainable(path, 40)
        refuse_collisions(path, task, task.sizes)
        refuse_large_sizes(path, task, task.sizes, 3.0)


def test_the_extent_is_that_of_all_drawings_together() -> None:
    assert extent(load_task(paths.DEFAULT_SHAPES)) == (5, 4)


def test_two_classes_that_are_one_drawing_at_a_size_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "alike.toml"
    shape = '[[shape]]\nlabel = "{}"\ngrid = """\n{}\n"""\n'
    file.write_text(shape.format("1", "#\n#\n#") + shape.format("7", "#\n#") + '[sizes]\nmore = ["5x1"]\n')
    task = load_task(file)
    with pytest.raises(UsageError, match=r"'1' and '7' are the same drawing at 5x1"):
        refuse_collisions(file, task, task.sizes)


def test_what_has_more_tiles_than_ids_is_not_trained_on(tmp_path: Path) -> None:
    file = tmp_path / "large.toml"
    block = "\n".join(["#" * 10] * 10)
    file.write_text(f'[[shape]]\nlabel = "0"\ngrid = """\n{block}\n"""\n[sizes]\nmore = ["15x15", "20x20"]\n')
    assert len(load_training_task([file], 1.5, 20)[0]) == 1
    with pytest.raises(UsageError, match=r"'0' has 400 tiles at 20x20; the most that ids allow are 255"):
        load_training_task([file], 2.0, 20)
    twice = "\n".join(["#" * 20] * 20)
    file.write_text(f'[[shape]]\nlabel = "0"\ngrid = """\n{twice}\n"""\n')
    with pytest.raises(UsageError, match=r"large.toml: shape '0' has 400 tiles"):
        load_training_task([file], 1.0, 20)
