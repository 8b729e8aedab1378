"""What tests of training begin with: circumstances, short trainings of two drawings."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca import cli
from tilenca.base import paths
from tilenca.model.file import Dimensions
from tilenca.shapes.batch import Batch, load_training_task
from tilenca.training.config import Config
from tilenca.training.curriculum import labels_of
from tilenca.training.recipe import Recipe
from tilenca.training.recipes import RECIPES
from tilenca.training.runner import Job, make_trainer
from tilenca.training.trainer import Trainer
from tilenca.training.update_schedule import Circumstances

SMOKE = RECIPES["smoke"]
DAMAGE = replace(SMOKE, directions=2.0, one_tile=1.0, damaged=0.5, unknown=0.1, switch=1.0, reset=0.0)


def usual(batch: Batch, **given: NDArray[np.bool_]) -> Circumstances:
    """All tiles on, running and known, but for what is given."""
    per_sample, per_cell = (np.zeros(len(what), np.bool_) for what in (batch.starts, batch.sample))
    nothing = {"staggered": per_sample, "away": per_cell, "lossless": per_sample, "fresh": per_cell}
    return Circumstances(**(nothing | given))


def train(shapes: Path, out: Path, *more: str) -> int:
    words = [
        "train",
        "--shapes",
        str(shapes),
        "--out",
        str(out),
        "--recipe",
        "smoke",
        "--hidden",
        "12",
        "--seed",
        "5",
        *more,
    ]
    return cli.main(words)


def trainer(seed: int = 1, recipe: Recipe = SMOKE) -> Trainer:
    return make_trainer(job_of([paths.DEFAULT_SHAPES], paths.BUILD, seed, recipe=recipe))


def job_of(files: list[Path], out: Path, seed: int = 5, hidden: int = 12, recipe: Recipe = SMOKE) -> Job:
    task, sizes = load_training_task(files, recipe.stretch, 20)
    task = replace(task, labels=labels_of(task, recipe, 20))
    directions = 4 if recipe.directions else 0
    dimensions = Dimensions(21 + directions, hidden, hidden, directions)
    config = Config(recipe, dimensions, seed, task.labels, task.sources)
    return Job(config, task, sizes, "cpu", out, resume=False)
