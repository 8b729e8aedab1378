"""`tilenca shapes`: pictures and facts of a shape file."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageDraw

from tilenca import cli
from tilenca.base import paths
from tilenca.shapes.file import load_task
from tilenca.shapes.stretch import Rows
from tilenca.shapes.variant import TRAINED, Variants, split_of


def run(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert cli.main(["shapes", *words]) == 0
    return capsys.readouterr().out


def test_every_drawing_is_shown_and_counted(capsys: pytest.CaptureFixture[str]) -> None:
    out = run(capsys)
    assert "4 5x4" in out
    assert "10 drawings of 10 classes: 0 1 2 3 4 5 6 7 8 9" in out
    assert "may become" not in out
    assert "tiles will show\n┏━┓    ╻  ╺━┓" in out
    assert "one tile makes the difference between" in out


def test_the_json_says_what_the_contract_asks(capsys: pytest.CaptureFixture[str]) -> None:
    report = json.loads(run(capsys, str(paths.DEFAULT_SHAPES), "--json"))
    four = next(shape for shape in report["shapes"] if shape["label"] == "4")
    assert four == {"label": "4", "rows": 5, "cols": 4, "tiles": 10, "display": "bcfg"}
    assert report["problems"] == []
    assert any("6 and 8" in sentence for sentence in report["advice"])
    assert "variants" not in report


def test_variants_held_out_are_printed_as_a_file_that_can_be_evaluated(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "hands.toml"
    file.write_text(run(capsys, "--vary", "2", "--held-out", "--toml", "--seed", "5"))
    task = load_task(file)
    assert task.labels == tuple("0123456789")
    assert len(task.shapes) == 20
    assert not {split_of(shape.rows) for shape in task.shapes} & {TRAINED}
    for option in ("--toml", "--held-out"):
        assert cli.main(["shapes", option]) == 2
        assert "add --vary" in capsys.readouterr().err


def test_variants_are_drawn_by_seed_and_are_those_of_training(capsys: pytest.CaptureFixture[str]) -> None:
    one, same, other = (
        json.loads(run(capsys, "--json", "--vary", "3", "--seed", seed))["variants"] for seed in "112"
    )
    assert one == same != other
    assert {label: len(some) for label, some in one.items()} == dict.fromkeys("0123456789", 3)
    assert all(split_of(tuple(grid.split("\n"))) == TRAINED for some in one.values() for grid in some)
    assert "8 may become" in run(capsys, "--vary", "2")


def test_what_was_drawn_for_two_classes_is_left_out(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the file could not be read again: no drawing may have two labels."""
    some = Variants.some

    def with_a_bar(self: Variants, label: str, *rest: Any) -> list[Rows]:
        return [*some(self, label, *rest), ("#", "#", "#")] if label in "17" else some(self, label, *rest)

    monkeypatch.setattr(Variants, "some", with_a_bar)
    assert cli.main(["shapes", "--vary", "2", "--toml"]) == 0
    printed = capsys.readouterr()
    assert printed.out.count("[[shape]]") == 20
    assert "1 drawing was drawn for two classes and left out" in printed.err


def test_a_file_may_have_no_variants(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('vary = false\n[[shape]]\nlabel = "L"\ngrid = """\n#.\n##\n"""\n')
    assert cli.main(["shapes", str(file), "--vary"]) == 2
    assert "vary = false" in capsys.readouterr().err


def test_more_classes_than_the_state_holds_are_a_problem_not_an_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    letters = paths.DEFAULT_SHAPES.parent / "letters.toml"
    (problem,) = json.loads(run(capsys, str(letters), "--json"))["problems"]
    assert "26 classes" in problem
    assert "--state" in problem
    assert problem in run(capsys, str(letters))


def test_a_picture_becomes_a_table_that_a_shape_file_takes(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    ink = np.kron(np.array([[1, 1, 1], [0, 0, 1], [0, 0, 1]], np.uint8), np.ones((30, 30), np.uint8))
    Image.fromarray(255 - 255 * np.pad(ink, 7)).save(tmp_path / "seven.png")
    out = run(capsys, "--image", str(tmp_path / "seven.png"), "--size", "6x6", "--label", "7")
    (tmp_path / "mine.toml").write_text(out)
    (shape,) = load_task(tmp_path / "mine.toml").shapes
    assert (shape.label, shape.rows) == ("7", ("######",) * 2 + ("....##",) * 4)
    report = json.loads(run(capsys, "--image", str(tmp_path / "seven.png"), "--json"))
    assert (report["rows"], report["cols"]) == (10, 10)


def test_a_thin_slanted_stroke_stays_whole(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = Image.new("L", (200, 240), 255)
    ImageDraw.Draw(picture).line([(30, 30), (170, 30), (90, 210)], fill=0, width=14)
    picture.save(tmp_path / "seven.png")
    report = json.loads(run(capsys, "--image", str(tmp_path / "seven.png"), "--size", "10x8", "--json"))
    assert (report["rows"], report["cols"]) == (10, 8)
    assert cli.main(["shapes", "--image", str(tmp_path / "seven.png"), "--size", "10x8", "--ink", "0.5"]) == 0
    assert "tiles with ink do not touch the others" in capsys.readouterr().err


def test_variants_that_cannot_be_drawn_are_an_error(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "mine.toml"
    shape = '[[shape]]\nlabel = "t"\ngrid = """\n.#.\n###\n.#.\n.##\n"""\n'
    file.write_text(f'[vary]\nfrom = "2x2"\nto = "2x2"\n{shape}')
    assert cli.main(["shapes", str(file), "--vary"]) == 2
    assert "allow larger sizes" in capsys.readouterr().err


def test_a_picture_without_enough_ink_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    Image.fromarray(np.tile(np.array([0, 255], np.uint8), (20, 10))).save(tmp_path / "grey.png")
    assert cli.main(["shapes", "--image", str(tmp_path / "grey.png"), "--size", "2x2", "--ink", "0.9"]) == 2
    assert "give a smaller --ink" in capsys.readouterr().err


def test_a_drawing_with_more_tiles_than_ids_is_a_problem(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "block.toml"
    block = "\n".join(["#" * 20] * 20)
    file.write_text(f'[[shape]]\nlabel = "0"\ngrid = """\n{block}\n"""\n')
    assert "shape '0' has 400 tiles; the most that ids allow are 255" in run(capsys, str(file))
