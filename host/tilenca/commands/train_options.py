"""The options of a training, for every command that trains."""

import argparse

from tilenca.base.shipped import model_folder
from tilenca.commands.arguments import add_scheduler_argument, count, number, seed, whole
from tilenca.model.file import DEFAULT_CHANNELS, MAX_WIDTH
from tilenca.protocol.constants import MAX_CHANNELS
from tilenca.training.recipes import RECIPES

ITERATIONS = ", ".join(f"{name} {recipe.iterations:,}" for name, recipe in RECIPES.items())


def add_training_arguments(parser: argparse.ArgumentParser, usual: str) -> None:
    """Adds what decides how a model is trained, where, and whether it may replace another one.

    Args:
        parser: of the command.
        usual: the recipe where none is given.
    """
    add = parser.add_argument
    add(
        "--recipe",
        default=usual,
        metavar="NAME",
        help=f"one of: {' '.join(RECIPES)} ({usual}; quick is for trying out drawings)",
    )
    add("--seed", type=seed, default=1, metavar="N", help="same seed, same model (default 1)")
    add(
        "--seeds",
        type=whole(1, 64),
        metavar="K",
        help="train seeds N to N+K-1, keep the best (as many as the recipe says)",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--jobs", type=whole(1, 64), metavar="J", help="seeds to train at once (one for each processor)"
    )
    add_scheduler_argument(where.add_argument)
    add("--iterations", type=count, metavar="N", help=f"optimiser steps (by the recipe: {ITERATIONS})")
    add(
        "--learning-rate",
        type=number(1e-6, 0.1),
        metavar="R",
        help="Adam's at the beginning (by the recipe; smaller steps for --weights that are good already)",
    )
    add(
        "--state",
        type=whole(2, MAX_CHANNELS),
        metavar="C",
        help=f"channels of the state ({DEFAULT_CHANNELS}, or as many as --weights has)",
    )
    add(
        "--hidden",
        type=whole(1, MAX_WIDTH),
        metavar="H",
        help="width of both hidden layers (as the recipe says, or --weights has)",
    )
    add(
        "--weights",
        type=model_folder,
        metavar="MODEL",
        help="begin with the weights of this model, of the same classes and no wider (random ones)",
    )
    add("--device", default="cpu", metavar="NAME", help="cpu (default) or cuda")
    add(
        "--validation-runs",
        type=count,
        metavar="N",
        help="runs per drawing in the final measurement (as many as the recipe says)",
    )
    add(
        "--tensorboard",
        action="store_true",
        help="write event files for TensorBoard into DIR/tensorboard, too; needs that package",
    )
    add("--force", action="store_true", help="replace the model in DIR, unless it is the better one")
