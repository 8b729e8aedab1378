"""The table [sizes] of a shape file, and the curriculum and suite that come of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.evaluation.suites import Aims, make_suite
from tilenca.shapes import batch, variants
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import UNKNOWN, Task, load_task
from tilenca.training.curriculum import build, labels_of
from tilenca.training.recipes import RECIPES, aims_of

L_SHAPE = '[[shape]]\nlabel = "L"\ngrid = """\n#.\n##\n"""\n'
FULL = replace(RECIPES["full"], stretch=1.5)


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
        ('[sizes]\nform = "3x3"', "has no 'form'; it has from, to, more, held_out, drawn"),
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

    monkeypatch.setattr(batch, "load_task", load)
    load_training_task([paths.DEFAULT_SHAPES], 1.0, 20)
    assert read == ["digits.toml"]
    load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    assert read[1:] == ["digits.toml", "digits-3x3.toml"]


def test_the_curriculum_has_every_kind_in_its_share_and_nothing_held_out() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    task = replace(task, labels=labels_of(task, FULL, 20))
    curriculum = build(task, FULL, sizes, np.random.default_rng(1))
    shapes, weights = curriculum.drawings.shapes, curriculum.weights
    assert weights.sum() == pytest.approx(1)
    unknown = np.array([shape.label == UNKNOWN for shape in shapes])
    damaged = np.array([shape.name.endswith("damaged") for shape in shapes])
    assert weights[unknown].sum() == pytest.approx(FULL.unknown)
    assert weights[damaged].sum() == pytest.approx(FULL.damaged)
    assert {shape.label for shape in shapes} == {*"0123456789", UNKNOWN}
    assert not any(variants.held_out(shape.rows) for shape, none in zip(shapes, unknown, strict=True) if none)
    asked = make_suite(task, sizes, task.labels, aims_of(FULL), seed=1)
    new = {s.rows for case in (*asked.sizes, *asked.unknown) if case.held_out for s in case.drawings.shapes}
    assert new.isdisjoint(shape.rows for shape in shapes)
    drawn = {(len(shape.rows), len(shape.rows[0])) for shape in shapes if shape.label == "8"}
    assert (7, 6) in drawn
    assert not drawn & set(sizes.held_out)
    assert max(rows for rows, _ in drawn) <= 1.5 * 5, "the recipe stretches half as much again at most"


def test_the_same_seed_draws_the_same_curriculum() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    task = replace(task, labels=labels_of(task, FULL, 20))
    one, same, other = (
        [s.rows for s in build(task, FULL, sizes, np.random.default_rng(seed)).drawings.shapes]
        for seed in (1, 1, 2)
    )
    assert one == same
    assert one != other


def test_a_state_without_room_for_a_dash_gets_none() -> None:
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    assert labels_of(task, FULL, 11) == (*"0123456789", UNKNOWN)
    assert labels_of(task, FULL, 10) == tuple("0123456789")
    assert labels_of(task, replace(FULL, unknown=0.0), 20) == tuple("0123456789")


def test_the_exam_asks_for_what_training_never_saw() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    labels = (*task.labels, UNKNOWN)
    suite = make_suite(task, sizes, labels, Aims(10.0, True, True), seed=1)
    assert [case.name for case in suite.drawn] == ["digits.toml", "digits-3x3.toml"]
    held_out = [case for case in suite.sizes if case.held_out]
    assert [case.name.split(",")[0] for case in held_out] == [
        "8x5",
        "9x7",
        "11x9",
        "13x10",
        "14x12",
        "20x16",
    ]
    assert [case.steps for case in held_out] == [60, 100, 100, 100, 100, 200]
    assert len(suite.unknown) == 3
    for case in suite.unknown:
        assert all(variants.held_out(shape.rows) for shape in case.drawings.shapes)
    assert [case.name for case in suite.larger] == ["7x6", "12x10"]
    assert make_suite(task, sizes, task.labels, Aims(), seed=1).unknown == (), (
        "a model that knows no dash is not asked"
    )


def test_the_papers_recipe_trains_on_one_size_and_is_asked_about_others() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], RECIPES["paper"].stretch, 20)
    assert [source["file"] for source in task.sources] == ["digits.toml"]
    suite = make_suite(task, sizes, task.labels, aims_of(RECIPES["paper"]), seed=1)
    asked = [case.name for case in suite.sizes]
    assert asked[:2] == ["digits-3x3.toml, never trained on", "7x6, never trained on"]
    assert not any(case.aimed for case in suite.sizes)


def test_a_model_is_measured_against_what_it_was_trained_for_only() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    suite = make_suite(task, sizes, task.labels, Aims(stretch=1.5, damaged=False), seed=1)
    aimed = {case.name.split(",")[0]: case.aimed for case in suite.sizes if case.held_out}
    assert aimed == {"8x5": True, "9x7": True, "11x9": False, "13x10": False, "14x12": False, "20x16": False}
    assert suite.damaged is not None
    assert not suite.damaged.aimed
    assert [case.name for case in suite.larger] == ["7x6"]
