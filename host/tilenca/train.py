"""`tilenca train`: drawings in, a checked and quantised model out."""

import argparse
import json
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from tilenca import paths
from tilenca.arguments import count, seed, whole
from tilenca.drawings import load_drawings
from tilenca.errors import InterruptedRunError, TilencaError, UsageError
from tilenca.modelfile import CHECKPOINT, MAX_CHANNELS, MAX_WIDTH, Dimensions, Model
from tilenca.recipes import RECIPES, find_recipe

if TYPE_CHECKING:
    from tilenca.training import StepReport, Trainer

CHECKPOINT_EVERY_S = 45.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "--shapes",
        type=Path,
        nargs="+",
        default=[paths.DEFAULT_SHAPES],
        metavar="F",
        help="shape files, one task",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the model goes")
    parser.add_argument("--recipe", default="default", metavar="NAME", help=f"one of: {' '.join(RECIPES)}")
    parser.add_argument("--seed", type=seed, default=1, metavar="N", help="same seed, same model (default 1)")
    parser.add_argument("--iterations", type=count, metavar="N", help="instead of the recipe's")
    parser.add_argument(
        "--state",
        type=whole(2, MAX_CHANNELS),
        default=21,
        metavar="C",
        help="channels of the state (default 21)",
    )
    parser.add_argument(
        "--hidden", type=whole(1, MAX_WIDTH), default=40, metavar="H", help="width of both hidden layers (40)"
    )
    parser.add_argument("--device", default="cpu", metavar="NAME", help="cpu (default) or cuda")
    parser.add_argument(
        "--validation-runs", type=count, metavar="N", help="runs per drawing, instead of the recipe's"
    )
    parser.add_argument("--resume", action="store_true", help="continue the interrupted run in DIR")
    parser.add_argument("--force", action="store_true", help="replace the model in DIR")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Trains, validates, quantises, writes."""
    started = time.monotonic()
    dimensions = Dimensions(args.state, args.hidden, args.hidden)
    drawings = load_drawings(args.shapes, dimensions.max_classes)
    recipe = find_recipe(args.recipe)
    if args.iterations is not None:
        recipe = replace(recipe, iterations=args.iterations)
    validation_runs = recipe.validation_runs if args.validation_runs is None else args.validation_runs
    _check_out(args)
    torch = _import_torch(args.device)

    from tilenca.quantise import quantise
    from tilenca.tensors import IntegerEngine
    from tilenca.training import Config, Trainer
    from tilenca.validation import validate

    torch.set_num_threads(1)  # matrices this small gain nothing from a second thread
    config = Config(recipe, dimensions, args.seed, drawings.labels, drawings.sources)
    trainer = Trainer(config, drawings, torch.device(args.device))
    if args.resume:
        trainer.load(args.out / CHECKPOINT)
    _train(trainer, args)

    made = {
        "command": _command(args),
        "commit": _commit(),
        "recipe_name": args.recipe,
        **config.as_json(),
    }
    model, cut = quantise(dimensions, drawings.labels, trainer.net.arrays(), made)
    say = Console(stderr=True).print
    engine = IntegerEngine(model)
    try:
        metrics = validate(
            engine, drawings, validation_runs, args.seed, lambda what: say(f"measuring {what}")
        )
    except KeyboardInterrupt:
        raise _interrupted(args, "while measuring the trained model") from None
    metrics["weights_cut"] = cut
    _write(args.out, model, metrics, trainer.history)
    _report(args, model, metrics, time.monotonic() - started)
    return 0


def _check_out(args: argparse.Namespace) -> None:
    if (args.out / "model.json").exists() and not (args.resume or args.force):
        raise UsageError(f"{args.out}: holds a model already; give another --out, or --force to replace it")
    if (args.out / CHECKPOINT).exists() and not (args.resume or args.force):
        raise UsageError(
            f"{args.out}: holds an unfinished run; add --resume to continue it, --force to start anew"
        )
    if args.resume and not (args.out / CHECKPOINT).exists():
        raise UsageError(f"{args.out}: no {CHECKPOINT} to resume; train without --resume")
    try:
        args.out.mkdir(parents=True, exist_ok=True)
        probe = args.out / ".write-probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise UsageError(f"{args.out}: cannot write there ({error.strerror}); give another --out") from error


def _import_torch(device: str) -> Any:
    try:
        import torch
    except ImportError as error:
        raise UsageError("training needs PyTorch, which is not installed; run: make setup-train") from error
    if device not in ("cpu", "cuda"):
        raise UsageError(f"--device {device}: use cpu or cuda")
    if device == "cuda" and not torch.cuda.is_available():
        raise UsageError("--device cuda: PyTorch finds no CUDA device here; use --device cpu")
    return torch


def _train(trainer: "Trainer", args: argparse.Namespace) -> None:
    """Trains to the end; when interrupted raises, with everything done so far in the checkpoint."""
    checkpoint = args.out / CHECKPOINT
    saved = time.monotonic()
    with _interruptible() as interrupted, _progress(trainer) as show:
        while trainer.iteration < trainer.config.recipe.iterations:
            show(trainer.step())
            if interrupted() or time.monotonic() - saved > CHECKPOINT_EVERY_S:
                trainer.save(checkpoint)
                saved = time.monotonic()
            if interrupted():
                break
    if trainer.iteration < trainer.config.recipe.iterations:
        raise _interrupted(args, f"at iteration {trainer.iteration}")
    trainer.save(checkpoint)  # measuring takes a while, and can be interrupted too


def _interrupted(args: argparse.Namespace, where: str) -> InterruptedRunError:
    return InterruptedRunError(f"interrupted {where}; continue with: {_command(args)} --resume")


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """Ctrl-C waits for the end of the step, so that what is saved is whole; a second one does not."""
    caught: list[int] = []

    def note(number: int, _frame: object) -> None:
        caught.append(number)
        signal.signal(number, signal.default_int_handler)

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: bool(caught)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _progress(trainer: "Trainer") -> Iterator[Callable[["StepReport"], None]]:
    """A progress bar on a terminal, a line now and then elsewhere; both on stderr."""
    console = Console(stderr=True)
    total = trainer.config.recipe.iterations
    bar = Progress(
        TextColumn("training"),
        BarColumn(),
        TextColumn("{task.completed}/{task.total}  {task.fields[note]}"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
    print(
        f"training {total - trainer.iteration} iterations on {len(trainer.drawings)} drawings of "
        f"{len(trainer.drawings.labels)} classes; Ctrl-C keeps a checkpoint",
        file=sys.stderr,
        flush=True,
    )
    with bar:
        task = bar.add_task("training", total=total, completed=trainer.iteration, note="")
        begun, first = time.monotonic(), trainer.iteration

        def show(step: "StepReport") -> None:
            loss, agreement = trainer.recent()
            rate = (step.iteration - first) / max(time.monotonic() - begun, 1e-9)
            note = f"loss {loss:.4f}  agree {agreement:.3f}  {rate:.0f}/s"
            bar.update(task, completed=step.iteration, note=note)
            if not console.is_terminal and step.iteration % max(total // 10, 1) == 0:
                left_s = (total - step.iteration) / rate
                print(f"training {step.iteration}/{total}  {note}  {left_s:.0f} s left", file=sys.stderr)

        yield show


def _command(args: argparse.Namespace) -> str:
    """The command that makes this model; paths inside the project as seen from its root."""

    def place(path: Path) -> str:
        full = path.resolve()
        return str(full.relative_to(paths.ROOT) if full.is_relative_to(paths.ROOT) else path)

    words = ["tilenca", "train", "--shapes", *map(place, args.shapes), "--out", place(args.out)]
    words += ["--recipe", args.recipe, "--seed", str(args.seed)]
    words += ["--iterations", str(args.iterations or find_recipe(args.recipe).iterations)]
    for option, default in (("state", 21), ("hidden", 40), ("device", "cpu")):
        if (value := getattr(args, option)) != default:
            words += [f"--{option}", str(value)]
    if args.validation_runs is not None:
        words += ["--validation-runs", str(args.validation_runs)]
    return shlex.join(words)


def _commit() -> str:
    """The commit this runs on, `-dirty` when tracked files differ; "unknown" outside a repository."""
    git = shutil.which("git")
    if git is None:
        return "unknown"
    words = [git, "-C", str(paths.ROOT), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def _write(out: Path, model: Model, metrics: dict[str, Any], history: list[tuple[int, float, float]]) -> None:
    from tilenca.card import render_card

    try:
        model.save(out)
        (out / "metrics.json").write_text(json.dumps(metrics, indent=2) + "\n", encoding="utf-8")
        rows = [f"{iteration},{loss:.6f},{agreement:.4f}" for iteration, loss, agreement in history]
        (out / "history.csv").write_text(
            "\n".join(["iteration,loss,agreement", *rows]) + "\n", encoding="utf-8"
        )
        (out / "README.md").write_text(render_card(model, metrics), encoding="utf-8")
        (out / CHECKPOINT).unlink(missing_ok=True)
    except OSError as error:
        raise TilencaError(
            f"{out}: cannot write the model ({error.strerror}); free some space and --resume"
        ) from error


def _report(args: argparse.Namespace, model: Model, metrics: dict[str, Any], seconds: float) -> None:
    if args.json:
        print(json.dumps({"model": str(args.out), "seconds": round(seconds, 1), "metrics": metrics}))
        return
    print(f"model {model.model_id:04X} in {args.out}, {seconds:.0f} s")
    for schedule, files in metrics["agreement"].items():
        for file, row in files.items():
            print(f"  {file:20} {schedule:6}  @10 {row['10']:.3f}  @30 {row['30']:.3f}  @60 {row['60']:.3f}")
