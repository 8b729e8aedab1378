"""Which drawings a sweep asks for."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.evaluation.suites import VARIANTS, Aims, varied_case
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import UNKNOWN, load_task
from tilenca.shapes.variant import LAST
from tilenca.sweep.subjects import Subjects


@cache
def digits(*only: str) -> Subjects:
    return Subjects(load_model(paths.DEFAULT_MODEL), [paths.DEFAULT_SHAPES], 1, only)


def test_drawn_are_those_of_the_file_each_a_row() -> None:
    subjects = digits().at("drawn", "drawn")
    assert [subject.name for subject in subjects] == list("0123456789")
    assert [subject.shapes[0].rows for subject in subjects] == [
        shape.rows for shape in load_task(paths.DEFAULT_SHAPES).shapes
    ]
    assert {subject.file for subject in subjects} == {"digits.toml"}


def test_at_a_size_names_stay_and_drawings_grow() -> None:
    subjects = digits().at("drawn", "9x7")
    assert [subject.name for subject in subjects] == list("0123456789")
    assert max(len(subject.shapes[0].rows) for subject in subjects) == 9


def test_damaged_lack_one_tile_and_are_a_row_for_each_label() -> None:
    whole = {subject.name: subject.tiles for subject in digits().at("drawn", "drawn")}
    for subject in digits().at("damaged", "drawn"):
        assert subject.tiles == whole[subject.name] - 1
        assert {shape.label for shape in subject.shapes} == {subject.name}


def test_varied_are_the_variants_of_the_test_suite(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(VARIANTS, LAST, 1)  # of each class; more take seconds
    model = load_model(paths.DEFAULT_MODEL)
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 10.0, model.dimensions.max_classes, model.labels)
    case = varied_case(replace(task, labels=model.labels), Aims(), 1, LAST)
    assert case is not None
    subjects = Subjects(model, [paths.DEFAULT_SHAPES], 1).at("varied", "drawn")
    assert [subject.name for subject in subjects] == list("0123456789")
    assert [shape for subject in subjects for shape in subject.shapes] == list(case.drawings.shapes)


def test_unknown_are_no_class_and_have_their_own_sizes() -> None:
    assert [subject.label for subject in digits().at("unknown", "drawn")] == [UNKNOWN]
    assert len(digits().at("unknown", "drawn")[0].shapes) > 100
    with pytest.raises(UsageError, match="these have sizes of their own"):
        digits().at("unknown", "7x6")


def test_only_those_asked_for() -> None:
    assert [subject.name for subject in digits("4", "7").at("drawn", "drawn")] == ["4", "7"]
    with pytest.raises(UsageError, match=r"no drawing 'x'; there is: 0 1 2 3"):
        digits("4", "x").at("drawn", "drawn")


def test_a_size_at_which_nothing_can_be_drawn_is_refused() -> None:
    with pytest.raises(UsageError, match="size=1x1: no drawing; there is: none"):
        digits().at("drawn", "1x1")


def test_a_model_without_a_dash_is_not_asked_for_one(tmp_path: Path) -> None:
    paper = load_model(paths.MODELS / "paper")
    assert UNKNOWN not in paper.labels
    with pytest.raises(UsageError, match="has no dash to show"):
        Subjects(paper, [paths.DEFAULT_SHAPES], 1).at("unknown", "drawn")
