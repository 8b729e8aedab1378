"""The options of a training are the same in every command that trains."""

import argparse

import pytest

from tilenca.commands import make, train
from tilenca.commands.train_options import add_training_arguments
from tilenca.training.recipes import RECIPES


def options_of(parser: argparse.ArgumentParser) -> dict[str, str | None]:
    return {
        option: action.metavar if isinstance(action.metavar, str) else None
        for action in parser._actions
        for option in action.option_strings
    }


@pytest.mark.parametrize("command", [train, make])
def test_every_command_that_trains_takes_all_of_them(command: object) -> None:
    shared, whole = argparse.ArgumentParser(), argparse.ArgumentParser()
    add_training_arguments(shared, "full")
    command.add_arguments(whole)  # type: ignore[attr-defined]
    assert options_of(shared).items() <= options_of(whole).items()


@pytest.mark.parametrize("usual", ["full", "quick"])
def test_the_usual_recipe_is_the_commands_and_all_are_listed(usual: str) -> None:
    parser = argparse.ArgumentParser()
    add_training_arguments(parser, usual)
    args = parser.parse_args([])
    assert (args.recipe, args.seed, args.device) == (usual, 1, "cpu")
    assert (
        args.state
        is args.weights
        is args.hidden
        is args.iterations
        is args.seeds
        is args.jobs
        is args.scheduler
        is None
    )
    assert " ".join(RECIPES) in parser.format_help()
