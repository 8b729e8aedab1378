"""The plan of `tilenca train`: the training that the arguments ask for, and whether it can begin."""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.base.stdio import warn
from tilenca.model import cost
from tilenca.model.directions import with_directions
from tilenca.model.file import (
    DEFAULT_CHANNELS,
    Dimensions,
    Model,
    checkpoint_path,
    checkpoints,
    load_model,
)
from tilenca.model.widen import widened
from tilenca.shapes.batch import Drawings, load_training_task
from tilenca.shapes.derive import known_of
from tilenca.shapes.file import UNKNOWN, load_task
from tilenca.shapes.sizes import Sizes
from tilenca.shapes.vary import Vary
from tilenca.training.curriculum import labels_of
from tilenca.training.generator import FEW
from tilenca.training.recipe import Recipe
from tilenca.training.recipes import find_recipe


@dataclass(frozen=True)
class TrainingPlan:
    """The training that the arguments ask for.

    Attributes:
        task: the drawings of the files, with the model's labels.
        sizes: of the task.
        recipe: with the arguments' changes.
        dimensions: of the network.
        seeds: to train.
        validation_runs: of each drawing in the final measurement.
        varies: whether the first file has a table `[vary]` or `[forms]`.
        initial: the model whose weights training begins with, if any.
    """

    task: Drawings
    sizes: Sizes
    recipe: Recipe
    dimensions: Dimensions
    seeds: tuple[int, ...]
    validation_runs: int
    varies: bool = False
    initial: Model | None = None


def make_plan(args: argparse.Namespace) -> TrainingPlan:
    """The plan of the arguments, with the drawings of their files.

    Raises:
        UsageError: there is no such recipe, or a shape file is not valid.
    """
    recipe = find_recipe(args.recipe)
    if args.iterations is not None:
        recipe = replace(recipe, iterations=args.iterations)
    if args.learning_rate is not None:
        recipe = replace(recipe, learning_rate=args.learning_rate)
    initial = None if args.weights is None else load_model(args.weights)
    if initial is not None and recipe.directions and not initial.dimensions.directions:
        initial = with_directions(initial)
    if initial is not None and initial.dimensions.directions and not recipe.directions:
        raise UsageError(
            f"{args.weights}: says where a tile is missing, and recipe {args.recipe} does not train that; "
            "begin with another model, or train by --recipe damage"
        )
    dimensions = _dimensions(args, recipe, initial)
    task, sizes = load_training_task(args.shapes, recipe.stretch, dimensions.max_classes)
    labels = labels_of(task, recipe, dimensions.max_classes)
    if initial is not None and initial.labels != labels:
        raise UsageError(
            f"{args.weights}: its classes are {' '.join(initial.labels)}, those of this training are "
            f"{' '.join(labels)}; begin with a model of the same classes, or without --weights"
        )
    if initial is not None and initial.dimensions != dimensions:
        initial = widened(initial, dimensions, np.random.default_rng(0))
    seeds = tuple(range(args.seed, args.seed + (args.seeds or recipe.seeds)))
    runs = args.validation_runs or recipe.validation_runs
    if recipe.varied:
        _check_variants(args.shapes[0], task)
    first = load_task(args.shapes[0])
    varies = bool(first.forms) or first.vary not in (None, Vary())
    task = replace(task, labels=labels)
    return TrainingPlan(task, sizes, recipe, dimensions, seeds, runs, varies, initial)


def usual_channels(recipe: Recipe) -> int:
    """The channels of the state where none are given."""
    return DEFAULT_CHANNELS + (len(SIDES) if recipe.directions else 0)


def _dimensions(args: argparse.Namespace, recipe: Recipe, initial: Model | None) -> Dimensions:
    """The widths that the arguments, the initial model or the recipe say.

    Raises:
        UsageError: an argument is less than the initial model has.
    """
    if initial is None:
        hidden = args.hidden or recipe.hidden
        directions = len(SIDES) if recipe.directions else 0
        return Dimensions(args.state or usual_channels(recipe), hidden, hidden, directions)
    theirs = initial.dimensions
    for option, width in (("state", theirs.channels), ("hidden", max(theirs.hidden1, theirs.hidden2))):
        if (asked := getattr(args, option)) is not None and asked < width:
            raise UsageError(
                f"{args.weights}: needs --{option} {width} or more, not {asked}; it can be left out"
            )
    hidden1, hidden2 = args.hidden or theirs.hidden1, args.hidden or theirs.hidden2
    return Dimensions(args.state or theirs.channels, hidden1, hidden2, theirs.directions)


def _check_variants(path: Path, task: Drawings) -> None:
    """Refuses classes of which no variant can be drawn.

    Raises:
        UsageError: the file allows too little; the message names it, the class and the remedy.
    """
    variants, random = task.variants, np.random.default_rng(0)
    if variants is None:
        return
    for label in variants.labels:
        several = any(len(shape.cells) > 1 for shape in task.shapes if shape.label == label)
        if several:
            variants.some(label, 1, random, path)


def doubts(plan: TrainingPlan) -> Iterator[str]:
    """What to know of the drawings and the recipe before a training, a line each."""
    if plan.recipe.unknown and UNKNOWN not in plan.task.labels:
        yield (
            f"note: {len(plan.task.labels)} classes leave the state no room for a dash; with a wider --state "
            "tiles would learn to say that they do not know"
        )
    if plan.recipe.damaged and len(plan.task) <= FEW:
        known = known_of(plan.task.shapes)
        alike = [f"{label} like {' '.join(others)}" for label, others in known.lookalikes().items()]
        if alike:
            yield f"note: with the wrong tile missing one looks like another: {', '.join(alike)}"
    if plan.recipe.varied and plan.task.variants is None:
        yield "note: drawings with areas, or with vary = false, have no forms: they alone are trained on"
    if plan.recipe.varied == 0 and plan.varies:
        yield "note: this recipe trains on the drawings alone; only --recipe forms heeds [vary] and [forms]"


def announce(plan: TrainingPlan, fits: cost.Fit) -> None:
    """Prints the cost on a tile, what to know of the drawings, and the plan."""
    warn(str(fits))
    for doubt in doubts(plan):
        warn(doubt)
    warn(
        f"training {plan.recipe.iterations} iterations on {len(plan.task)} drawings of "
        f"{len(plan.task.labels)} classes, {len(plan.seeds)} seed{'s' * (len(plan.seeds) > 1)}; Ctrl-C keeps "
        "a checkpoint"
    )
    met = "; how many targets of the model card are met, and by how much the others fall short, added up"
    warn(
        f"progress: the share of drawings with every tile right{met if plan.recipe.check_every else ''}; "
        "without a terminal a line a minute"
    )


def check_out(args: argparse.Namespace, plan: TrainingPlan) -> None:
    """Makes the output folder, unless it holds a model or a run that the arguments do not mean.

    Raises:
        UsageError: it does, or it cannot be written to.
    """
    unfinished = bool(checkpoints(args.out))
    if (args.out / "model.json").exists() and not (args.resume or args.force):
        raise UsageError(f"{args.out}: holds a model already; give another --out, or --force to replace it")
    if unfinished and not (args.resume or args.force):
        raise UsageError(
            f"{args.out}: holds an unfinished run; add --resume to continue it, --force to start anew"
        )
    if args.resume and not any(checkpoint_path(args.out, number).exists() for number in plan.seeds):
        raise UsageError(f"{args.out}: no checkpoint of this run to resume; train without --resume")
    try:
        args.out.mkdir(parents=True, exist_ok=True)
        probe = args.out / ".write-probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise UsageError(f"{args.out}: cannot write there ({error.strerror}); give another --out") from error
