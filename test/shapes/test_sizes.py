"""The table [sizes] of a shape file, and the curriculum and suite that come of it."""

from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.shapes import trainable
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import Task, load_task

L_SHAPE = '[[shape]]\nlabel = "L"\ngrid = """\n#.\n##\n"""\n'


def write(path: Path, sizes: str) -> Path:
    file = path / "some.toml"
    file.write_text(f"{sizes}\n{L_SHAPE}")
    return file


def test_the_digits_are_trained_up_to_12x10_and_the_sizes_held_out_are_not() -> None:
    sizes = load_task(paths.DEFAULT_SHAPES).sizes
    assert (5, 4) in sizes.trained
    assert (12, 10) in sizes.trained
    for size in ((8, 5), (9, 7), (11, 9), (13, 10), (14, 12)):
        assert size not in sizes.trained
        assert size in sizes.held_out
    assert [path.name for path in sizes.drawn] == ["digits-3x3.toml"]


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ("sizes = 3", "sizes must be a table"),
        ('[sizes]\nform = "3x3"', "did you mean 'from'"),
        ('[sizes]\nfrom = "3x3"', "one of from and to"),
        ('[sizes]\nfrom = "3x3"\nto = "3"', "to: '3' is not a size"),
        ('[sizes]\nfrom = "3x3"\nto = "0x7"', "to: '0x7' is not a size"),
        ("[sizes]\nfrom = 3\nto = 4", "from: '3' is not a size"),
        ('[sizes]\nfrom = "5x5"\nto = "7x4"', "from 5x5 is larger than to 7x4"),
        ('[sizes]\nheld_out = "3x3"', "held_out must be a list of texts"),
        ("[sizes]\nheld_out = [3]", "held_out must be a list of texts"),
        ('[sizes]\nmore = ["7x7"]\nheld_out = ["7x7"]', "7x7 is in more and in held_out"),
        ('[sizes]\nheld_out = ["101x3"]', "held_out: '101x3' is not a size"),
    ],
)
def test_a_table_that_makes_no_sense_is_refused(sizes: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"some\.toml: .*" + message):
        load_task(write(tmp_path, sizes))


def test_a_drawn_file_that_is_not_there_is_refused_by_name(tmp_path: Path) -> None:
    file = write(tmp_path, '[sizes]\ndrawn = ["nowhere.toml"]')
    with pytest.raises(UsageError, match=r"nowhere\.toml"):
        load_training_task([file], 10.0, 20)


def test_every_file_is_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []

    def load(path: Path, max_classes: int | None = None) -> Task:
        read.append(path.name)
        return load_task(path, max_classes)

    monkeypatch.setattr(trainable, "load_task", load)
    load_training_task([paths.DEFAULT_SHAPES], 1.0, 20)
    assert read == ["digits.toml"]
    load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    assert read[1:] == ["digits.toml", "digits-3x3.toml"]
