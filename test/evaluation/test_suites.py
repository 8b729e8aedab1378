"""What a model is asked: what training never saw, and what it was trained for."""

from dataclasses import asdict, replace
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.evaluation.suites import MOST_DRAWN, Aims, Suite, make_suite, recorded_aims
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.file import UNKNOWN, shape_table
from tilenca.shapes.stretch import Rows, smallest
from tilenca.shapes.variant import CHOOSING, LAST, TRAINED, split_of
from tilenca.training.recipe import aims_of
from tilenca.training.recipes import RECIPES


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
        "24x20",
        "30x24",
    ]
    assert [case.steps for case in held_out] == [60, 100, 100, 100, 100, 200, 300, 400]
    assert [case.kind for case in held_out[4:]] == ["held out", "very large", "huge", "huge"]
    assert len(suite.unknown) == 3
    for case in suite.unknown:
        assert all(split_of(shape.rows) == LAST for shape in case.drawings.shapes)
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
    assert {size for size, wanted in aimed.items() if wanted} == {"8x5", "9x7"}
    assert len(aimed) == 8
    assert suite.damaged
    assert not any(case.aimed for case in suite.damaged)
    assert [case.name for case in suite.larger] == ["7x6"]


def forms(suite: Suite) -> set[Rows]:
    cases = [case for case in (*suite.unknown, *suite.damaged) if case.held_out]
    return {smallest(shape.rows) for case in cases for shape in case.drawings.shapes}


def test_measurements_during_training_and_of_the_final_model_have_no_held_out_form_in_common() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    labels, aims = (*task.labels, UNKNOWN), Aims(10.0, True, True)
    selection, final = (forms(make_suite(task, sizes, labels, aims, 1, split)) for split in (CHOOSING, LAST))
    assert len(selection) > 300
    assert len(final) > 300
    assert selection.isdisjoint(final)


def test_a_tile_is_missing_at_every_size_once_in_new_pairs_and_once_in_others() -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    suite = make_suite(task, sizes, task.labels, Aims(10.0, damaged=True), seed=1)
    assert [case.name.split(",")[0] for case in suite.damaged] == [
        size for size in ("5x4", "6x4", "7x7", "8x6", "12x10") for _ in range(2)
    ]
    assert [case.held_out for case in suite.damaged] == [False, True] * 5
    assert [case.steps for case in suite.damaged[::2]] == [60, 60, 100, 100, 100]
    assert [case.kind for case in suite.damaged[::2]] == [*["damaged"] * 4, "damaged, large"]
    for old, new in zip(suite.damaged[::2], suite.damaged[1::2], strict=True):
        assert old.aimed
        assert new.aimed
        assert all(split_of(shape.rows) == TRAINED for shape in old.drawings.shapes)
        assert all(split_of(shape.rows) == LAST for shape in new.drawings.shapes)


@pytest.mark.parametrize("agreeing", [False, True])
def test_one_answer_on_any_drawing_has_a_target_only_where_the_training_aims_at_it(agreeing: bool) -> None:
    task, sizes = load_training_task([paths.DEFAULT_SHAPES], 1.5, 20)
    suite = make_suite(task, sizes, task.labels, Aims(1.5, agreeing=agreeing), seed=1)
    assert [case.aimed for case in suite.agreeing] == [agreeing] * 2


@pytest.mark.parametrize("name", RECIPES)
def test_a_model_records_the_aims_of_its_recipe(name: str) -> None:
    recipe, model = RECIPES[name], load_model(paths.DEFAULT_MODEL)
    size = replace(model.dimensions, directions=4 if recipe.directions else 0)
    model = replace(model, dimensions=size, metadata={"recipe": asdict(recipe)})
    assert recorded_aims(model) == aims_of(recipe)


@pytest.mark.parametrize("value", [None, "1", [], -1, 1e9, 10**400, float("nan"), float("inf")], ids=repr)
@pytest.mark.parametrize("name", ["stretch", "unknown"])
def test_aims_that_are_none_are_refused(name: str, value: object) -> None:
    """One of them has more digits than a float can hold."""
    model = replace(load_model(paths.DEFAULT_MODEL), metadata={"recipe": {name: value}})
    with pytest.raises(UsageError, match=r"metadata\.recipe has no numbers in it; train it again"):
        recorded_aims(model)


def test_of_a_file_with_very_many_drawings_some_are_asked_by_the_seed(tmp_path: Path) -> None:
    tops = (format(number, "09b").replace("0", ".").replace("1", "#") for number in range(1, 512))
    combs = [shape_table("1", (top, "#" * 9)) for top in tops]
    (tmp_path / "many.toml").write_text("vary = false\n" + "\n".join(combs))
    (tmp_path / "few.toml").write_text("vary = false\n" + shape_table("7", ("###", "..#")))
    task, sizes = load_training_task([tmp_path / "many.toml", tmp_path / "few.toml"], 1.0, 20)
    suites = [make_suite(task, sizes, task.labels, Aims(), seed) for seed in (1, 1, 2)]
    names = [case.name for case in suites[0].drawn]
    assert names == [f"many.toml, {MOST_DRAWN} of its drawings", "few.toml"]
    first, same, other = (suite.drawn[0].drawings.shapes for suite in suites)
    assert first == same != other
    assert len(set(first)) == MOST_DRAWN
    assert [shape.label for shape in suites[0].drawn[1].drawings.shapes] == ["7"]
    assert suites[0].dead == ()
    assert not suites[0].slow_changes


def test_files_that_are_never_trained_on_measure_the_model(tmp_path: Path) -> None:
    (tmp_path / "new.toml").write_text("vary = false\n" + shape_table("7", ("#" * 8, *["." * 7 + "#"] * 8)))
    first = shape_table("7", ("###", "..#")) + shape_table("1", ("#", "#", "#"))
    (tmp_path / "mine.toml").write_text('vary = false\n[sizes]\nmeasured = ["new.toml"]\n' + first)
    for stretch in (1.0, 10.0):
        task, sizes = load_training_task([tmp_path / "mine.toml"], stretch, 20)
        assert [source["file"] for source in task.sources] == ["mine.toml"], "not among those to train on"
        (case,) = (
            case
            for case in make_suite(task, sizes, task.labels, Aims(stretch), 1).sizes
            if case.name == "new.toml, never trained on"
        )
        assert (case.held_out, case.steps, len(case.drawings)) == (True, 100, 1)
