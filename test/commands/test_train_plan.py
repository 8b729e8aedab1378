"""The plan of a training: refusals before it begins, and what is announced."""

import argparse
from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.commands import train
from tilenca.commands.train_plan import announce, check_out, make_plan
from tilenca.model import cost
from tilenca.model.file import Dimensions


def arguments(out: Path, *more: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    train.add_arguments(parser)
    return parser.parse_args(["--out", str(out), "--recipe", "smoke", *more])


def test_arguments_change_the_recipe_and_the_network(tmp_path: Path) -> None:
    more = ("--iterations", "7", "--hidden", "24", "--state", "16", "--seed", "3", "--seeds", "2")
    plan = make_plan(arguments(tmp_path, *more, "--learning-rate", "2e-4"))
    assert (plan.recipe.iterations, plan.recipe.learning_rate) == (7, 2e-4)
    assert (plan.dimensions.channels, plan.dimensions.hidden1, plan.dimensions.hidden2) == (16, 24, 24)
    assert plan.seeds == (3, 4)
    assert plan.task.labels == (*"0123456789", "-")


def test_a_run_that_waits_to_be_resumed_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "checkpoint-1.pt").touch()
    args = arguments(tmp_path)
    with pytest.raises(UsageError, match="--resume"):
        check_out(args, make_plan(args))
    for option in ("--resume", "--force"):
        args = arguments(tmp_path, option)
        check_out(args, make_plan(args))


def test_a_run_of_another_seed_cannot_be_resumed(tmp_path: Path) -> None:
    (tmp_path / "checkpoint-1.pt").touch()
    args = arguments(tmp_path, "--resume", "--seed", "2")
    with pytest.raises(UsageError, match="no checkpoint of this run"):
        check_out(args, make_plan(args))


def test_lookalikes_are_announced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = make_plan(arguments(tmp_path))
    announce(plan, cost.check(plan.dimensions, len(plan.task.labels)))
    said = capsys.readouterr().err
    assert "training 40 iterations on" in said
    assert "with the wrong tile missing one looks like another" in said


@pytest.mark.parametrize(("recipe", "measures"), [("full", True), ("paper", False)])
def test_the_words_of_the_progress_line_are_explained(
    recipe: str, measures: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = make_plan(arguments(tmp_path, "--recipe", recipe))
    announce(plan, cost.check(plan.dimensions, len(plan.task.labels)))
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith("progress: the share of drawings with every tile right; ")
    assert ("how many targets of the model card are met" in last) == measures


def test_a_table_that_the_recipe_does_not_heed_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for recipe, told in (("quick", True), ("forms", False)):
        plan = make_plan(arguments(tmp_path, "--recipe", recipe))
        announce(plan, cost.check(plan.dimensions, len(plan.task.labels)))
        assert ("only --recipe forms heeds [vary]" in capsys.readouterr().err) == told


def test_classes_without_variants_are_refused_before_training(tmp_path: Path) -> None:
    shape = '[[shape]]\nlabel = "{}"\ngrid = """\n{}\n"""\n'
    text = '[vary]\nfrom = "2x2"\nto = "2x2"\n' + shape.format("8", "###\n#.#\n###\n#.#\n###")
    (tmp_path / "mine.toml").write_text(text + shape.format("L", "#..\n###"))
    args = arguments(tmp_path / "out", "--shapes", str(tmp_path / "mine.toml"), "--recipe", "forms")
    with pytest.raises(UsageError, match="no variant of '8' can be drawn; allow larger"):
        make_plan(args)


def test_a_training_begins_with_the_weights_of_a_model(tmp_path: Path) -> None:
    plan = make_plan(arguments(tmp_path, "--recipe", "forms", "--weights", "digits"))
    assert plan.initial is not None
    assert plan.dimensions == plan.initial.dimensions == Dimensions(24, 96, 96)


def test_a_model_without_directions_gets_them_where_the_recipe_trains_them(tmp_path: Path) -> None:
    plan = make_plan(arguments(tmp_path, "--recipe", "damage", "--weights", "digits-64"))
    assert plan.initial is not None
    assert plan.dimensions == plan.initial.dimensions == Dimensions(25, 64, 64, 4)
    plan.initial.save(tmp_path / "directed")
    with pytest.raises(UsageError, match="recipe full does not train that"):
        make_plan(arguments(tmp_path, "--recipe", "full", "--weights", str(tmp_path / "directed")))
    assert make_plan(arguments(tmp_path, "--recipe", "damage")).dimensions == Dimensions(25, 96, 96, 4)


def test_a_wider_network_begins_with_the_weights_of_a_narrower_one(tmp_path: Path) -> None:
    words = ["--weights", "digits-40", "--recipe", "full", "--state", "24", "--hidden", "48"]
    plans = [make_plan(arguments(tmp_path, *words)) for _ in range(2)]
    first, second = (plan.initial for plan in plans)
    assert first is not None
    assert second is not None
    assert plans[0].dimensions == first.dimensions == Dimensions(24, 48, 48)
    assert first.model_id == second.model_id


@pytest.mark.parametrize(
    ("more", "wanted"),
    [
        (["--weights", "digits", "--hidden", "40"], "needs --hidden 96 or more, not 40"),
        (["--weights", "digits", "--state", "21"], "needs --state 24 or more, not 21"),
        (["--weights", "letters"], "of the same classes"),
    ],
)
def test_weights_of_another_network_are_refused(tmp_path: Path, more: list[str], wanted: str) -> None:
    with pytest.raises(UsageError, match=wanted):
        make_plan(arguments(tmp_path, *more))
