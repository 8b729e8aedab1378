"""`tilenca make`: from drawings to tiles in one command; each step is a command of its own."""

import argparse
import hashlib
import json
import shlex
import shutil
import subprocess
import time
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.project import project
from tilenca.base.shipped import shapes_file
from tilenca.base.stdio import warn
from tilenca.commands import emulate, train
from tilenca.commands.arguments import Parser, count, seed, whole
from tilenca.commands.own_firmware import build_beside
from tilenca.commands.train_plan import TrainingPlan, make_plan
from tilenca.model.file import checkpoints, load_model
from tilenca.training.recipes import RECIPES
from tilenca.views.abilities import abilities

STEPS = 4
AROUND_S, AROUND_TILES = 90.0, 50  # to measure, build and emulate so many tiles, in round numbers
TIMED_STEPS = 3  # iterations that are timed before the training begins


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
    parser.add_argument(
        "--recipe", default="quick", metavar="NAME", help=f"one of: {' '.join(RECIPES)} (quick)"
    )
    parser.add_argument("--seed", type=seed, default=1, metavar="N", help="same seed, same model (1)")
    parser.add_argument(
        "--iterations", type=count, metavar="N", help="optimiser steps (as many as the recipe says)"
    )
    parser.add_argument("--hidden", type=whole(1, 127), metavar="H", help="width of both hidden layers")
    parser.add_argument(
        "--force", action="store_true", help="train anew, over the model that is in the folder"
    )


def run(args: argparse.Namespace) -> int:
    """Checks, trains, builds and emulates; 1 when too few targets hold, or a tile ends up wrong."""
    project()  # before minutes of training
    out: Path = args.out or Path("models") / args.shapes.stem
    _refuse_shipped(out)
    words = _training_words(args, out)
    parsed = _parsed(train, words)
    plan = make_plan(parsed)
    warn(
        _step(
            1, f"{len(plan.task)} drawings of {len(plan.task.labels)} classes: {' '.join(plan.task.labels)}"
        )
    )
    status = 0
    if _is_trained(args, plan, out):
        warn(_step(2, f"{out} was trained on this file already; --force trains it anew"))
    else:
        warn(_step(2, f"training; {_estimate(plan)}"))
        status = train.run(parsed)
    model = load_model(out)
    for line in abilities(json.loads((out / "metrics.json").read_text(encoding="utf-8"))):
        print(line)
    warn(_step(3, f"building the firmware of model {model.model_id:04X}, about a minute the first time"))
    image = build_beside(model, out)
    warn(_step(4, "emulating every drawing"))
    place = shlex.quote(str(out))
    status = max(status, emulate.run(_parsed(emulate, ["--model", str(out)])))
    print(f"model and firmware in {out}; the digits that ship are as they were: tilenca emulate")
    warn(
        f"next: tilenca emulate --model {place} --watch --seconds 10, or for real tiles "
        f"tilenca flash --hex {shlex.quote(str(image.with_suffix('.hex')))}"
    )
    return status


def _step(number: int, what: str) -> str:
    return f"[{number}/{STEPS}] {what}"


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


def _training_words(args: argparse.Namespace, out: Path) -> list[str]:
    words = [
        "--shapes",
        str(args.shapes),
        "--out",
        str(out),
        "--recipe",
        args.recipe,
        "--seed",
        str(args.seed),
    ]
    for name in ("iterations", "hidden"):
        if getattr(args, name) is not None:
            words += [f"--{name}", str(getattr(args, name))]
    if args.force:
        words += ["--force"]
    elif checkpoints(out):
        words += ["--resume"]
    return words


def _is_trained(args: argparse.Namespace, plan: TrainingPlan, out: Path) -> bool:
    """Whether the folder has the model that this training would make.

    Raises:
        UsageError: it has another model.
    """
    if args.force or checkpoints(out) or not (out / "model.json").exists():
        return False
    model = load_model(out)
    metadata = model.metadata
    there = (
        metadata.get("sources", [{}])[0].get("sha256"), metadata.get("recipe_name"), metadata.get("seed"),
        metadata.get("recipe", {}).get("iterations"), model.dimensions,
    )  # fmt: skip
    sha256 = hashlib.sha256(args.shapes.read_bytes()).hexdigest()
    if there == (sha256, args.recipe, args.seed, plan.recipe.iterations, plan.dimensions):
        return True
    raise UsageError(
        f"{out}: holds a model of another file, recipe, seed or size; give another --out, or --force to "
        "replace it"
    )


def _estimate(plan: TrainingPlan) -> str:
    """How long the training takes at most, from some iterations on this machine."""
    from tilenca.base.processors import processors
    from tilenca.training.runner import Job, make_trainer
    from tilenca.training.trainer import Config

    config = Config(plan.recipe, plan.dimensions, plan.seeds[0], plan.task.labels, plan.task.sources)
    threads = max(1, processors() // min(processors(), len(plan.seeds)))
    trainer = make_trainer(Job(config, plan.task, plan.sizes, "cpu", Path(), False, threads))
    trainer.step()  # the first one takes longer
    began_s, timed = time.perf_counter(), max(1, min(TIMED_STEPS, plan.recipe.iterations - 1))
    for _ in range(timed):
        trainer.step()
    each_s = (time.perf_counter() - began_s) / timed
    seeds = -(-len(plan.seeds) // processors())
    minutes = each_s * plan.recipe.iterations * seeds / 60
    around_s = AROUND_S * max(1.0, int(plan.task.sizes.sum()) / AROUND_TILES)
    after = f"then about {around_s / 60:.1f} min to measure, build and emulate"
    return f"at most about {max(1, round(minutes))} min, less if the targets hold early; {after}"
