"""`tilenca train`: drawings in, a checked and quantised model out."""

import argparse
import json
import time
from pathlib import Path
from typing import Any

from tilenca.base import paths
from tilenca.base.stdio import warn
from tilenca.commands.arguments import add_shapes_argument
from tilenca.commands.origin import without_a_dash
from tilenca.commands.train_options import add_training_arguments
from tilenca.commands.train_plan import announce, check_out, make_plan
from tilenca.commands.train_steps import check_resumed, train_model, training_command
from tilenca.model import cost
from tilenca.training.device import check_device
from tilenca.training.tensorboard import check_tensorboard
from tilenca.views.training import TrainingViews

MOST_MISSED = 8  # missed targets to print, the worst ones first
FIT = 0.8  # least share of the runs in which a model must name the drawings of its files


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    add_shapes_argument(
        parser.add_argument,
        "shape files, one task; the first may list other sizes at which its drawings keep their class",
        nargs="+",
        default=[paths.DEFAULT_SHAPES],
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the model's folder")
    add_training_arguments(parser, "full")
    parser.add_argument("--resume", action="store_true", help="continue the interrupted run in DIR")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Trains, measures, quantises, writes."""
    started = time.monotonic()
    plan = make_plan(args)
    check_device(args.device)
    if args.tensorboard:
        check_tensorboard()
    fits = cost.check(plan.dimensions, len(plan.task.labels))
    check_out(args, plan)
    check_resumed(args, plan)
    announce(plan, fits)
    go_on = f"continue with: {training_command(args, str)} --resume"
    made = train_model(args, plan, TrainingViews(), go_on)
    report(args, made.folder, made.metrics, time.monotonic() - started)
    if (note := without_a_dash(made.model)) is not None:
        warn(note)
    return judged(args.recipe, made.metrics)


def judged(recipe: str, metrics: dict[str, Any]) -> int:
    """The exit status of a training: 1, which is told, where the model should not be relied on."""
    named = share_named(metrics)
    if recipe == "smoke" or named >= FIT:
        return 0
    warn(f"tilenca: names its own drawings in {named:.0%} of the runs only: do not rely on this model")
    return 1


def share_named(metrics: dict[str, Any]) -> float:
    """The least share of the runs, of all schedules, in which a model names the drawings of its files."""
    rows = (row for row in metrics["rows"] if row["key"] == "drawings" and row["target"] is not None)
    return min((float(row["share"]) for row in rows), default=0.0)


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
