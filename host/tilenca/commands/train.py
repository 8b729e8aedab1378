"""`tilenca train`: drawings in, a checked and quantised model out."""

import argparse
import json
import shlex
import shutil
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tilenca import __version__
from tilenca.base import paths
from tilenca.base.errors import InterruptedRunError, TilencaError, UsageError
from tilenca.base.project import place_of
from tilenca.base.shipped import model_folder
from tilenca.base.stdio import warn
from tilenca.commands.arguments import add_scheduler_argument, add_shapes_argument, count, seed, whole
from tilenca.commands.origin import without_a_dash
from tilenca.commands.train_cluster import train_on_cluster
from tilenca.commands.train_plan import TrainingPlan, announce, check_out, make_plan
from tilenca.evaluation.suites import make_suite
from tilenca.model import cost
from tilenca.model.file import DEFAULT_CHANNELS, MAX_WIDTH, checkpoints
from tilenca.protocol.constants import MAX_CHANNELS
from tilenca.shapes.variant import CHOOSING
from tilenca.training.device import check_device
from tilenca.training.recipes import RECIPES, aims_of, find_recipe

if TYPE_CHECKING:
    from tilenca.training.results import Result
    from tilenca.training.runner import Job
    from tilenca.training.trainer import Trained

SUITE_SEED = 1_000_000  # larger than any usual --seed, so that training never draws the same numbers
MOST_MISSED = 8  # missed targets to print, the worst ones first
FIT = 0.8  # least share of the runs in which a model must name the drawings of its files
SELECTION_RUNS = 50  # of each drawing, to choose among seeds


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    add_shapes_argument(
        parser.add_argument,
        "shape files, one task; the first may list other sizes at which its drawings keep their class",
        nargs="+",
        default=[paths.DEFAULT_SHAPES],
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the model's folder")
    parser.add_argument(
        "--recipe",
        default="full",
        metavar="NAME",
        help=f"one of: {' '.join(RECIPES)} (full; quick is for trying out drawings)",
    )
    parser.add_argument("--seed", type=seed, default=1, metavar="N", help="same seed, same model (default 1)")
    parser.add_argument(
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
    parser.add_argument(
        "--iterations", type=count, metavar="N", help="optimiser steps (as many as the recipe says)"
    )
    parser.add_argument(
        "--state",
        type=whole(2, MAX_CHANNELS),
        metavar="C",
        help=f"channels of the state (default {DEFAULT_CHANNELS})",
    )
    parser.add_argument(
        "--hidden",
        type=whole(1, MAX_WIDTH),
        metavar="H",
        help="width of both hidden layers (as the recipe says)",
    )
    parser.add_argument(
        "--weights",
        type=model_folder,
        metavar="MODEL",
        help="begin with the weights of this model, of the same classes and widths (random ones)",
    )
    parser.add_argument("--device", default="cpu", metavar="NAME", help="cpu (default) or cuda")
    parser.add_argument(
        "--validation-runs",
        type=count,
        metavar="N",
        help="runs per drawing in the final measurement (as many as the recipe says)",
    )
    parser.add_argument("--resume", action="store_true", help="continue the interrupted run in DIR")
    parser.add_argument(
        "--force", action="store_true", help="replace the model in DIR, unless it is the better one"
    )
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Trains, measures, quantises, writes."""
    started = time.monotonic()
    plan = make_plan(args)
    check_device(args.device)
    fits = cost.check(plan.dimensions, len(plan.task.labels))
    check_out(args, plan)
    announce(plan, fits)
    metadata = _metadata(args)  # the commit may change while the training runs
    jobs = _train(args, plan)
    try:
        result = _measured(plan, _best(jobs, args.seed), SUITE_SEED + args.seed, metadata, args.out)
    except KeyboardInterrupt:
        raise _interrupted(args, "while measuring the trained model") from None

    from tilenca.training.results import keep

    where = keep(args.out, result)
    _draw_history(where, result)
    for path in checkpoints(args.out):
        path.unlink()
    report(args, where, result.metrics, time.monotonic() - started)
    if (note := without_a_dash(result.model)) is not None:
        warn(note)
    if args.recipe != "smoke" and (named := share_named(result.metrics)) < FIT:
        warn(f"tilenca: names its own drawings in {named:.0%} of the runs only: do not rely on this model")
        return 1
    return 0


def share_named(metrics: dict[str, Any]) -> float:
    """The least share of the runs, of all schedules, in which a model names the drawings of its files."""
    rows = (row for row in metrics["rows"] if row["key"] == "drawings" and row["target"] is not None)
    return min((float(row["share"]) for row in rows), default=0.0)


def _train(args: argparse.Namespace, plan: TrainingPlan) -> "list[Job]":
    """Trains all seeds; returns their jobs, whose checkpoints hold the results."""
    from tilenca.base.processors import processors
    from tilenca.training.runner import Job, train_side_by_side
    from tilenca.training.trainer import Config
    from tilenca.views.training import show_training

    configs = [
        Config(plan.recipe, plan.dimensions, n, plan.task.labels, plan.task.sources, plan.initial)
        for n in plan.seeds
    ]
    at_once = min(args.jobs or processors(), len(configs))
    threads = max(1, processors() // at_once) if args.scheduler is None else 1
    jobs = [
        Job(config, plan.task, plan.sizes, args.device, args.out, args.resume, threads) for config in configs
    ]
    with show_training(plan.seeds, plan.recipe.iterations) as tell:
        try:
            if args.scheduler is None:
                failures = train_side_by_side(jobs, at_once, tell)
            else:
                failures = train_on_cluster(jobs, args.scheduler, tell)
        except (InterruptedRunError, KeyboardInterrupt) as error:
            raise _interrupted(args, str(error) or "while training") from None
    for failure in failures:
        warn(failure)
    return jobs


def _metadata(args: argparse.Namespace) -> dict[str, object]:
    """The model's origin, as far as its configuration does not tell it."""
    return {
        "command": _command(args),
        "shapes": [place_of(path) for path in args.shapes],
        "commit": _commit(),
        "recipe_name": args.recipe,
    }


def _measured(
    plan: TrainingPlan, trained: "Trained", suite_seed: int, metadata: dict[str, object], out: Path
) -> "Result":
    """The integer model of a training, and its metrics.

    Args:
        plan: of the training.
        trained: the best seed.
        suite_seed: other runs and other random drawings than those that decided when to stop, and which seed
            is best.
        metadata: of the model.
        out: the model's folder.
    """
    from tilenca.evaluation.validation import validate
    from tilenca.simulator.engine import FastEngine
    from tilenca.training.results import Result
    from tilenca.training.trainer import model_of
    from tilenca.views.training import show_measuring

    model, cut = model_of(trained, {**metadata, **trained.config.as_json()})
    suite = make_suite(plan.task, plan.sizes, model.labels, aims_of(plan.recipe), suite_seed)
    with show_measuring(str(out / "README.md")) as tell:
        metrics = validate(FastEngine(model), suite, plan.validation_runs, suite_seed, tell)
    metrics |= {"weights_cut": cut, "iterations": trained.iteration, "ended_early": trained.ended}
    metrics["best_iteration"] = trained.best_iteration
    return Result(model, metrics, trained.history, trained.checks)


def _draw_history(where: Path, result: "Result") -> None:
    from tilenca.training.results import history_table
    from tilenca.views.plots import plot_history

    if result.history:
        columns, rows = history_table(result)
        title = f"Training of model {result.model.model_id:04X}"
        plot_history(rows, where / "history.png", columns, title)


def _best(jobs: "list[Job]", suite_seed: int) -> "Trained":
    """The finished run with the least shortfall."""
    from tilenca.evaluation.evaluator import Evaluator
    from tilenca.simulator.engine import FastEngine
    from tilenca.training.trainer import model_of, trained_at

    finished = []
    for job in jobs:
        with suppress(UsageError):  # a failure of this run has been reported already
            finished.append(trained_at(job.checkpoint, job.config))
    finished = [trained for trained in finished if trained.done]
    if not finished:
        raise TilencaError("no seed was trained to its end; see above, or try another --seed")
    if len(finished) == 1:
        return finished[0]
    shortfalls = []
    for trained in finished:
        model, _ = model_of(trained, {})
        suite = make_suite(
            jobs[0].task, jobs[0].sizes, model.labels, aims_of(trained.config.recipe), suite_seed, CHOOSING
        )
        rows = Evaluator(FastEngine(model), suite, SELECTION_RUNS, suite_seed).short_rows()
        shortfalls.append(sum(row.shortfall for row in rows))
        warn(f"seed {trained.config.seed}: short of its targets by {shortfalls[-1]:.4f} in all")
    return finished[shortfalls.index(min(shortfalls))]


def _interrupted(args: argparse.Namespace, where: str) -> InterruptedRunError:
    if not checkpoints(args.out):
        return InterruptedRunError(f"interrupted {where}, before there was anything to keep")
    return InterruptedRunError(f"interrupted {where}; continue with: {_command(args, str)} --resume")


def _command(args: argparse.Namespace, place: Callable[[Path], str] = place_of) -> str:
    """The command that makes this model."""
    recipe = find_recipe(args.recipe)
    words = ["tilenca", "train", "--shapes", *map(place, args.shapes), "--out", place(args.out)]
    words += ["--recipe", args.recipe, "--seed", str(args.seed)]
    words += ["--seeds", str(args.seeds or recipe.seeds)]
    words += ["--iterations", str(args.iterations or recipe.iterations)]
    if args.weights is None:
        words += ["--hidden", str(args.hidden or recipe.hidden)]
    else:
        words += ["--weights", place(args.weights)]
    for option, default in (("state", DEFAULT_CHANNELS), ("device", "cpu"), ("validation_runs", None)):
        if (value := getattr(args, option)) not in (None, default):
            words += [f"--{option.replace('_', '-')}", str(value)]
    return shlex.join(words)


def _commit() -> str:
    """The commit this runs on, `-dirty` when tracked files differ; of an installed wheel, its version."""
    if paths.CHECKOUT is None:
        return f"tilenca {__version__}"
    git = shutil.which("git")
    if git is None:
        return "unknown"
    words = [git, "-C", str(paths.CHECKOUT), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def _reached(row: dict[str, Any]) -> float:
    """The part of its target that a row reached."""
    return float(row["share"]) / float(row["target"])


def report(args: argparse.Namespace, where: Path, metrics: dict[str, Any], seconds: float) -> None:
    """Prints where the model is, the targets that it missed most, and what to do next."""
    if args.json:
        print(json.dumps({"model": str(where), "seconds": round(seconds, 1), "metrics": metrics}))
        return
    missed = sorted((row for row in metrics["rows"] if not row["holds"]), key=_reached)
    print(f"model in {where}, {seconds:.0f} s; {metrics['targets_held']} targets held")
    for row in missed[:MOST_MISSED]:
        worst, least = row["worst"], f", wanted {row['floor']:.1%}" if row["floor"] else ""
        print(
            f"  missed: {row['name']}, after {row['steps']} steps: {row['share']:.1%} of the runs, "
            f"wanted {row['target']:.1%}; the worst drawing, {worst['shape']}: {worst['share']:.1%}{least}"
        )
    if len(missed) > MOST_MISSED:
        print(f"  and {len(missed) - MOST_MISSED} more, all in {where / 'README.md'}")
    if missed and args.recipe == "smoke":
        warn("note: recipe smoke only tries the commands; a model that works takes --recipe quick or full")
    elif missed:
        warn("note: more of them hold with more --iterations or --seeds, a wider --hidden, or --recipe full")
    warn(
        f"next: tilenca evaluate --model {where}, or tilenca export --model {where} --build and then "
        f"tilenca emulate --model {where}"
    )
