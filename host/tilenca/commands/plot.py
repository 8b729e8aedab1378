"""`tilenca plot`: pictures of how training went, and of tiles at work."""

import argparse
import csv
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.shipped import model_folder
from tilenca.base.stdio import warn
from tilenca.commands.arguments import OWN_SHAPES, add_model_argument, add_shapes_argument, seed, whole
from tilenca.commands.origin import shapes_or_own
from tilenca.evaluation.metrics_file import read_metrics
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings
from tilenca.shapes.file import find_shape
from tilenca.simulator.conditions import ScheduleKind

if TYPE_CHECKING:
    from tilenca.views.abilities import Targets
    from tilenca.views.reel import Reel

HISTORY_FILE = "history.csv"
FILM_SUFFIXES = (".png", ".svg", ".gif")
FILM_OPTIONS = ("shape", "then", "every", "replay", "shapes", "steps", "schedule", "seed")
FILM_STEPS = 19
MAX_STEPS = 500


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("folder", nargs="?", type=model_folder, metavar="DIR", help="the same as --model DIR")
    add_model_argument(parser)
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="where the picture of the training goes (the model's directory; for a model that comes with an "
        "installed tilenca, this folder)",
    )
    parser.add_argument(
        "--format", choices=("png", "svg"), default="png", help="of the picture of the training (png)"
    )
    film = parser.add_argument_group(
        "film", "instead: what the tiles of a shape show, step by step, or those of a recording"
    )
    film.add_argument(
        "--film", type=Path, metavar="FILE", help="all steps in one .png or .svg, or an animated .gif"
    )
    film.add_argument(
        "--shape", metavar="NAME", help="the shape to film, such as 4, or 4@2 if the label has two drawings"
    )
    film.add_argument(
        "--then", metavar="NAME", help="the shape into which its tiles are rebuilt while they run"
    )
    film.add_argument(
        "--every",
        type=whole(1, MAX_STEPS),
        metavar="N",
        help="with --then: a tile comes or goes every N updates (all at once)",
    )
    film.add_argument(
        "--replay",
        type=Path,
        metavar="F",
        help="a recording instead, as monitor --record or emulate --record wrote it, faults and all",
    )
    add_shapes_argument(film.add_argument, "the file it is in", OWN_SHAPES)
    film.add_argument(
        "--steps",
        type=whole(1, MAX_STEPS),
        metavar="N",
        help=f"updates per tile; with --then, before and after ({FILM_STEPS}: twenty pictures)",
    )
    film.add_argument(
        "--schedule", choices=("random", "clock"), help="the paper's, or the tiles' own clocks (clock)"
    )
    film.add_argument("--seed", type=seed, metavar="N", help="same seed, same film (default 1)")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Draws, and prints which file."""
    if args.folder is not None:
        if args.model != paths.DEFAULT_MODEL:
            raise UsageError(f"{args.folder} and --model {args.model}: which one? give one model")
        args.model = args.folder
    report = _history(args) if args.film is None else _film(args)
    print(json.dumps(report) if args.json else report["file"])
    return 0


def _history(args: argparse.Namespace) -> dict[str, Any]:
    for name in FILM_OPTIONS:
        if getattr(args, name) is not None:
            raise UsageError(f"--{name} is of a film; add --film FILE.png or FILE.gif")
    from tilenca.views.plots import unwritable
    from tilenca.views.training_plot import plot_history

    model = load_model(args.model)
    columns, rows = read_history(args.model / HISTORY_FILE)
    out = args.out or _home(args.model)
    if out.suffix in FILM_SUFFIXES:
        raise UsageError(
            f"--out {out}: give a folder; --format names the kind of picture, --film FILE draws a film"
        )
    path = out / f"history.{args.format}"
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(out, error) from error
    title = f"Training of model {model.model_id:04X}"
    plot_history(rows, path, columns, title, _targets(args.model))
    return {"file": str(path), "model": f"{model.model_id:04X}", "rows": len(rows)}


def _targets(folder: Path) -> "dict[str, Targets]":
    """The model's targets by kind; none where it was not measured; damaged measurements are told."""
    from tilenca.views.abilities import targets_by_kind

    try:
        return targets_by_kind(read_metrics(folder))
    except UsageError as error:
        warn(f"note: {error}")
        return {}


def _home(model: Path) -> Path:
    """Where the picture goes by default: beside the model, but not into an installed package."""
    is_installed = paths.CHECKOUT is None and model.resolve().is_relative_to(paths.MODELS.resolve())
    return Path() if is_installed else model


def read_history(path: Path) -> tuple[list[str], list[list[float | None]]]:
    """The columns of a training history and its rows; an empty field is None.

    Raises:
        UsageError: no such file, or not a history; the message names the line.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give --model what `tilenca train` wrote") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{path}: not a training history ({error}); train again") from error
    columns, rows = (lines[0] if lines else []), []
    for number, line in enumerate(lines[1:], start=2):
        try:
            if len(line) != len(columns):
                raise ValueError(f"{len(line)} fields for {len(columns)} columns")
            rows.append([float(text) if text else None for text in line])
        except ValueError as error:
            raise UsageError(f"{path}:{number}: {error}; train again") from error
    return columns, rows


def _film(args: argparse.Namespace) -> dict[str, Any]:
    if args.out is not None:
        raise UsageError("--out is for the picture of the training; --film names its own file")
    if args.film.suffix not in FILM_SUFFIXES:
        raise UsageError(
            f"{args.film}: a film is written as {', '.join(FILM_SUFFIXES)}; give a name that ends so"
        )
    return _film_of_run(args) if args.replay is None else _film_of_recording(args)


def _film_of_recording(args: argparse.Namespace) -> dict[str, Any]:
    for name in FILM_OPTIONS:
        if name != "replay" and getattr(args, name) is not None:
            raise UsageError(f"--{name} is of a simulated run; --replay shows what was recorded")
    from tilenca.views.reel import of_recording

    reel = of_recording(args.replay)
    return {
        "file": str(args.film),
        "replay": str(args.replay),
        "tiles": len(reel.cells),
        "pictures": _draw(reel, args.film),
        "title": reel.title,
    }


def _film_of_run(args: argparse.Namespace) -> dict[str, Any]:
    if args.shape is None:
        raise UsageError("--film: of which shape? add --shape NAME, such as --shape 4, or --replay F")
    if args.every is not None and args.then is None:
        raise UsageError("--every says how a shape is rebuilt; add --then NAME")
    if args.then is not None and args.schedule == "random":
        raise UsageError("--then is for tiles on their own clocks; leave --schedule random out")
    from tilenca.simulator.trace import record, record_change
    from tilenca.views.reel import of_run

    model = load_model(args.model)
    shapes = shapes_or_own(args.shapes and [args.shapes], model, args.model)
    drawings = load_drawings(shapes, labels=model.labels)
    number = find_shape(drawings.shapes, args.shape, shapes[0])
    schedule: ScheduleKind = args.schedule or "clock"
    steps = args.steps or FILM_STEPS
    chance = 1 if args.seed is None else args.seed
    if args.then is None:
        film = record(model, drawings, number, steps, schedule, chance)
    else:
        numbers = (number, find_shape(drawings.shapes, args.then, shapes[0]))
        film = record_change(model, drawings, numbers, steps, args.every or 0, chance)
    return {
        "file": str(args.film),
        "model": f"{model.model_id:04X}",
        "shape": args.shape,
        "then": args.then,
        "schedule": schedule,
        "seed": chance,
        "steps": len(film.shown) - 1,
        "pictures": _draw(of_run(film), args.film),
        "agreed_at": film.agreed_at,
    }


def _draw(reel: "Reel", path: Path) -> int:
    from tilenca.views.film import draw_gif, draw_strip

    return (draw_gif if path.suffix == ".gif" else draw_strip)(reel, path)
