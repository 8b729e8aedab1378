"""`tilenca make`: from drawings to tiles in one command; each step is a command of its own."""

import argparse
import hashlib
import json
import shlex
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from textwrap import fill
from threading import Lock
from typing import Any

from tilenca.base import paths
from tilenca.base.errors import InterruptedRunError, UsageError
from tilenca.base.processors import processors_text
from tilenca.base.project import project
from tilenca.base.shipped import shapes_file
from tilenca.base.signals import promising
from tilenca.base.stdio import warn
from tilenca.commands import emulate
from tilenca.commands.arguments import Parser
from tilenca.commands.emulate_runs import EmulationResult
from tilenca.commands.make_estimate import building_s, emulating_s, measuring_s, pace_of, training_s
from tilenca.commands.origin import without_a_dash
from tilenca.commands.own_firmware import build_beside
from tilenca.commands.train import judged
from tilenca.commands.train_options import add_training_arguments
from tilenca.commands.train_plan import TrainingPlan, check_out, doubts, make_plan
from tilenca.commands.train_steps import check_resumed, last_suite, train_model
from tilenca.evaluation.metrics_file import read_metrics
from tilenca.evaluation.suites import Suite
from tilenca.model import cost
from tilenca.model.file import Model, checkpoint_path, checkpoints, load_model
from tilenca.training.device import check_device
from tilenca.training.tensorboard import check_tensorboard
from tilenca.views.abilities import abilities
from tilenca.views.progress import Tell
from tilenca.views.steps import Steps, show_steps

CHECK, TRAIN, MEASURE, BUILD, EMULATE = STEPS = "check", "train", "measure", "build", "emulate"
NOTE_WIDTH = 79


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "shapes", type=shapes_file, metavar="FILE", help="the shape file, such as my-shapes.toml"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="the model's folder, firmware included (models/ and FILE's name)",
    )
    add_training_arguments(parser, "quick")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Checks, trains, builds and emulates; 1 when too few targets hold, or a tile ends up wrong."""
    project()  # before minutes of training
    _complete(args)
    _refuse_shipped(args.out)
    plan = make_plan(args)
    check_device(args.device)
    if args.tensorboard:
        check_tensorboard()
    fits = cost.check(plan.dimensions, len(plan.task.labels))
    done = _is_trained(args, plan)
    if not done:
        _check_unfinished(args, plan)
        check_out(args, plan)
        check_resumed(args, plan)
    with show_steps(STEPS, TRAIN) as steps:
        try:
            with promising("nothing is lost but the check; ends as soon as the part at work is done"):
                suite = _check(args, plan, fits, done, steps)
        except KeyboardInterrupt:
            raise InterruptedRunError(
                "interrupted while checking: nothing is lost but the check; run the same command again"
            ) from None
        status = 0 if done else _train(args, plan, suite, steps)
        model = load_model(args.out)
        steps.begin(BUILD)
        image = build_beside(model, args.out, args.force, quiet=True)
        steps.end(BUILD, f"firmware of model {model.model_id:04X}")
        emulating = _parsed(emulate, ["--model", str(args.out), *(["--json"] if args.json else [])])
        results = _emulated(emulating, steps)
    metrics = read_metrics(args.out)
    if args.json:
        print(json.dumps(_document(args, model, image, metrics, results)))
        emulate.tell_notes(results)
        right = all(result.report["all_right"] for result in results)
        return max(status, judged(args.recipe, metrics), 0 if right else 1)
    status = max(status, emulate.tell_results(emulating, results))
    _tell(args, model, metrics)
    return max(status, judged(args.recipe, metrics))


def _complete(args: argparse.Namespace) -> None:
    """Adds what a training takes and this command decides."""
    args.shapes = [args.shapes]
    args.out = args.out or Path("models") / args.shapes[0].stem
    args.resume = not args.force and bool(checkpoints(args.out))


def _check_unfinished(args: argparse.Namespace, plan: TrainingPlan) -> None:
    """Refuses to go on with the seed of another run."""
    if args.resume and not any(checkpoint_path(args.out, number).exists() for number in plan.seeds):
        raise UsageError(
            f"{args.out}: holds an unfinished run of another seed; give another --out, or "
            "--force to start anew"
        )


def _check(
    args: argparse.Namespace, plan: TrainingPlan, fits: cost.Fit, done: bool, steps: Steps
) -> Suite | None:
    """Says what to know of the drawings, and how long all will take; returns what the model is asked."""
    steps.begin(CHECK)
    steps.move(CHECK, "1 of 4, looking for drawings that are alike")
    for note in doubts(plan):
        warn(note)
    if not fits.fits_period:
        warn(str(fits))
    suite = None
    if done:
        pace = pace_of(load_model(args.out), plan.task)
    elif args.scheduler is None:  # nobody knows how fast a cluster is
        steps.move(CHECK, "2 of 4, timing the first iterations")
        train_s, untrained = training_s(args, plan)
        steps.expect(TRAIN, train_s)
        steps.move(CHECK, "3 of 4, making the drawings that the model will be measured with")
        pace, suite = pace_of(untrained, plan.task), last_suite(args, plan)
        steps.move(CHECK, "4 of 4, counting the measurements")
        steps.expect(MEASURE, measuring_s(untrained, suite, plan.validation_runs, pace))
    if done or args.scheduler is None:
        steps.expect(BUILD, building_s(args, pace))
        steps.expect(EMULATE, emulating_s(args, plan, pace))
    labels = plan.task.labels
    steps.end(CHECK, f"{len(plan.task)} drawings of {len(labels)} classes: {' '.join(labels)}")
    if expected := steps.expected():
        warn(f"estimated on {processors_text()}: {expected}")
    if done:
        steps.end(TRAIN, "trained on this file before; --force trains anew")
        steps.end(MEASURE, f"{args.out / 'README.md'}")
    return suite


def _train(args: argparse.Namespace, plan: TrainingPlan, suite: Suite | None, steps: Steps) -> int:
    """Trains and measures a model; 1 where the folder kept a better one."""
    steps.begin(TRAIN)
    go_on = "to go on, run the same command again"
    made = train_model(args, plan, steps.training_views(TRAIN, MEASURE), go_on, suite)
    steps.end(MEASURE, f"{made.metrics['targets_held']} targets held")
    return 0 if made.folder == args.out else 1


def _emulated(args: argparse.Namespace, steps: Steps) -> list[EmulationResult]:
    """Emulates every drawing."""
    steps.begin(EMULATE)

    @contextmanager
    def shown() -> Iterator[Tell]:
        shares: dict[str, float] = {}
        lock = Lock()  # several drawings run at once

        def tell(name: str, share: float, note: str) -> None:
            with lock:
                shares[name] = share
                words = ", ".join(f"{name} {share:.0%}" for name, share in shares.items() if share < 1.0)
            steps.move(EMULATE, words)

        yield tell

    results = emulate.emulate_model(args, shown)
    right = sum(result.report["all_right"] for result in results)
    steps.end(EMULATE, f"{right} of {len(results)} drawings right")
    return results


def _tell(args: argparse.Namespace, model: Model, metrics: dict[str, Any]) -> None:
    """Prints what the model can do, where it is, and what to type next."""
    place = shlex.quote(str(args.out))
    notes = [*abilities(metrics), *filter(None, [without_a_dash(model)])]
    print(f"model {model.model_id:04X} in {place}, firmware included: {metrics['targets_held']} targets held")
    for note in notes:
        print(fill(note, NOTE_WIDTH, initial_indent="  ", subsequent_indent="    ", break_long_words=False))
    for what, then in (
        ("next, watch them", f"tilenca emulate --model {place} --watch"),
        ("pull a tile", f"tilenca emulate --model {place} --seconds 5 --fault off@1:3"),
        ("for real tiles", f"tilenca flash --model {place}"),
        ("all measurements", str(args.out / "README.md")),
        ("the digits again", "tilenca emulate"),
    ):
        warn(f"{what}: {then}")


def _document(
    args: argparse.Namespace,
    model: Model,
    image: Path,
    metrics: dict[str, Any],
    results: list[EmulationResult],
) -> dict[str, Any]:
    """The result as plain values."""
    return {
        "model": str(args.out),
        "model_id": f"{model.model_id:04X}",
        "image": str(image),
        "metrics": metrics,
        "runs": [result.report for result in results],
        "all_right": all(result.report["all_right"] for result in results),
    }


def _refuse_shipped(out: Path) -> None:
    """Refuses the folder of a model that comes with tilenca: in a wheel, or under git."""
    about = out.resolve() / "model.json"
    comes_with = about.is_relative_to(paths.MODELS.resolve()) and about.exists()
    if comes_with and paths.CHECKOUT is not None:
        git = shutil.which("git")
        words = ["-C", str(paths.CHECKOUT), "ls-files", "--error-unmatch", str(about)]
        comes_with = git is not None and not subprocess.run([git, *words], capture_output=True).returncode
    if comes_with:
        raise UsageError(f"{out}: comes with tilenca and stays as it is; give another folder with --out")


def _parsed(command: object, words: list[str]) -> argparse.Namespace:
    """The arguments of another command."""
    parser = Parser(prog="tilenca")
    command.add_arguments(parser)  # type: ignore[attr-defined]
    parsed: argparse.Namespace = parser.parse_args(words)
    return parsed


def _is_trained(args: argparse.Namespace, plan: TrainingPlan) -> bool:
    """Whether the folder has the model that this training would make.

    Raises:
        UsageError: it has another model, or one without measurements.
    """
    if args.force or checkpoints(args.out) or not (args.out / "model.json").exists():
        return False
    model = load_model(args.out)
    metadata = model.metadata
    there: tuple[object, ...] = ()
    match metadata:
        case {"sources": [{"sha256": sha256}], "recipe": {"iterations": iterations}}:
            there = sha256, metadata.get("recipe_name"), _seeds(metadata), iterations, metadata.get("initial")
    asked = (
        hashlib.sha256(args.shapes[0].read_bytes()).hexdigest(), args.recipe, plan.seeds,
        plan.recipe.iterations, None if plan.initial is None else f"{plan.initial.model_id:04X}",
    )  # fmt: skip
    if there == asked and model.dimensions == plan.dimensions:
        if {"rows", "targets_held"} <= read_metrics(args.out).keys():
            return True
        raise UsageError(f"{args.out}: holds a model without its measurements; --force trains it again")
    raise UsageError(
        f"{args.out}: holds a model of another file, recipe, seed, size or --weights; give another --out, or "
        "--force to replace it"
    )


def _seeds(metadata: Mapping[str, Any]) -> tuple[int, ...]:
    """The seeds of which a model is the best one, by the command that made it; none where it tells none."""
    with suppress(ValueError, IndexError):
        words = shlex.split(str(metadata.get("command", "")))
        first, count = (int(words[words.index(option) + 1]) for option in ("--seed", "--seeds"))
        return tuple(range(first, first + count))
    return ()
