"""`tilenca simulate`: many runs of drawings on the firmware's core, compiled for this machine."""

import argparse
import json
import re
import time
from contextlib import ExitStack
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from tilenca.base.errors import UsageError
from tilenca.base.processors import processors
from tilenca.base.suggest import did_you_mean
from tilenca.commands.arguments import (
    OWN_SHAPES,
    add_condition_arguments,
    add_model_argument,
    add_shapes_argument,
    count,
    seed,
    whole,
)
from tilenca.commands.origin import shapes_or_own
from tilenca.evaluation.metrics import convergence_times
from tilenca.model.file import Model, load_model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.shapes.file import Shape
from tilenca.shapes.glyphs import DARK_LOOK, look_of_class
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.rollout_library import DARK
from tilenca.simulator.simulator import Simulator
from tilenca.views.progress import Tell, show_progress
from tilenca.views.table import table
from tilenca.views.tiles import Picture, fitting

DEFAULT_STEPS = 60
RUNS = 100
MAX_SIDE = 1000  # of an array
MAX_THREADS = 256
STEP_S = DEFAULT_PERIOD_MS / 1000  # at the pace of real tiles
ALL = "all"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add = parser.add_argument
    add_model_argument(parser)
    add_shapes_argument(add, "shape files", OWN_SHAPES, nargs="+")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--shape",
        action="append",
        metavar="NAME",
        help="a shape, such as 4, or 4@2 if the label has two drawings; again for more (default: all)",
    )
    what.add_argument(
        "--array",
        type=_sides,
        metavar="RxC",
        help="a full block of so many rows and columns of tiles instead",
    )
    add("--steps", type=count, default=DEFAULT_STEPS, metavar="N", help=f"updates per tile ({DEFAULT_STEPS})")
    add("--runs", type=count, metavar="N", help=f"runs per shape ({RUNS}; --array, --watch: 1)")
    add_condition_arguments(parser)
    add("--seed", type=seed, default=1, metavar="N", help="same seed, same runs (1)")
    add("--threads", type=whole(1, MAX_THREADS), metavar="N", help="threads (one per processor)")
    look = parser.add_mutually_exclusive_group()
    look.add_argument("--json", action="store_true", help="one JSON document on stdout")
    look.add_argument("--watch", action="store_true", help="show what every tile shows, step by step")


def run(args: argparse.Namespace) -> int:
    """Runs the command."""
    _check_combinations(args)
    model = load_model(args.model)
    if not args.array:
        args.shapes = shapes_or_own(args.shapes, model, args.model)
    drawings = _block(model, *args.array) if args.array else load_drawings(args.shapes, labels=model.labels)
    numbers = _chosen(drawings, args)
    random = np.random.default_rng(args.seed)
    if args.watch:
        for number in numbers:
            simulator = _simulator(args, model, drawings, np.array([number]), random)
            _watch(simulator, drawings.shapes[number], model.labels, args.steps)
        return 0
    runs = args.runs or (1 if args.array else RUNS)
    reports = []
    with show_progress() as tell:
        for number in numbers:
            tell(drawings.shapes[number].name, 0.0, "laying out")
            simulator = _simulator(args, model, drawings, np.full(runs, number), random)
            reports.append(_report(args, simulator, drawings, number, tell))
    if args.json:
        print(json.dumps(reports[0] if len(reports) == 1 else {"shapes": reports, **_speed(reports)}))
    else:
        _print(args, reports)
    return 0


def _sides(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text)
    sides = tuple(int(side) for side in found.groups()) if found else (0, 0)
    if not all(1 <= side <= MAX_SIDE for side in sides):
        raise argparse.ArgumentTypeError(
            f"'{text}' is not rows and columns like 100x100, each from 1 to {MAX_SIDE}"
        )
    return sides[0], sides[1]


def _check_combinations(args: argparse.Namespace) -> None:
    """Refuses options that would be ignored; argparse refuses those that exclude each other."""
    if args.array and args.shapes:
        raise UsageError("--shapes does nothing with --array; leave one out")
    if args.array and args.watch:
        raise UsageError("--watch shows drawings; give --shape NAME instead of --array")
    if args.watch and args.runs is not None:
        raise UsageError("--watch shows one run of each shape; leave --runs out")


def _block(model: Model, rows: int, cols: int) -> Drawings:
    """A full block of tiles; it has no class, so no tile of it is right or wrong."""
    shape = Shape(model.labels[0], ("#" * cols,) * rows, f"{rows}x{cols}")
    return Drawings((shape,), (0,), model.labels, ({"file": "", "sha256": ""},))


def _chosen(drawings: Drawings, args: argparse.Namespace) -> list[int]:
    """Numbers of the drawings asked for; a name may be in several files."""
    names = [shape.name for shape in drawings.shapes]
    wanted = args.shape or [ALL]
    for name in wanted:
        if name not in (ALL, *names):
            files = ", ".join(map(str, args.shapes))
            raise UsageError(
                f"{files}: no shape '{name}'{did_you_mean(name, names)}; there is: "
                f"{' '.join(dict.fromkeys(names))}"
            )
    return [number for number, name in enumerate(names) if ALL in wanted or name in wanted]


def _simulator(
    args: argparse.Namespace,
    model: Model,
    drawings: Drawings,
    chosen: NDArray[np.int64],
    random: np.random.Generator,
) -> Simulator:
    conditions = Conditions(args.schedule, loss=args.loss, lost=args.lost, dead=args.dead)
    return Simulator(FastEngine(model), drawings, chosen, conditions, random, threads=args.threads)


def _report(
    args: argparse.Namespace, simulator: Simulator, drawings: Drawings, number: int, tell: Tell
) -> dict[str, Any]:
    name, steps = drawings.shapes[number].name, args.steps

    def tell_step(done: int) -> None:
        tell(name, done / steps, f"{done} of {_steps(steps)}")

    started_s = time.perf_counter()
    tell_step(0)
    trajectory = simulator.run(steps, tell=tell_step)
    seconds = time.perf_counter() - started_s
    shown = simulator.shown[simulator.alive]
    right: dict[str, Any] = {
        "cells_right": round(float(trajectory.right[-1].mean()), 6),
        "total_agreement": round(float(trajectory.agreed[-1].mean()), 6),
        "steps_to_agreement": convergence_times(trajectory.converged_at),
        "by_step": {
            "cells_right": np.round(trajectory.right.mean(axis=1, dtype=np.float64), 6).tolist(),
            "total_agreement": np.round(trajectory.agreed.mean(axis=1), 6).tolist(),
        },
    }
    return {
        "shape": name,
        "file": drawings.sources[drawings.groups[number]]["file"],
        "tiles": len(drawings.shapes[number].cells),
        "steps": steps,
        "runs": len(simulator.batch.starts),
        **(dict.fromkeys(right) if args.array else right),
        "shown": {
            label: round(float((shown == index).mean()), 6)
            for index, label in enumerate(drawings.labels)
            if (shown == index).any()
        },
        **_speed([{"cell_updates": simulator.updates, "seconds": seconds}]),
    }


def _speed(reports: list[dict[str, Any]]) -> dict[str, Any]:
    updates, seconds = (sum(report[key] for report in reports) for key in ("cell_updates", "seconds"))
    return {
        "cell_updates": updates,
        "seconds": round(seconds, 6),
        "updates_per_second": round(updates / max(seconds, 1e-6)),
    }


def _print(args: argparse.Namespace, reports: list[dict[str, Any]]) -> None:
    if args.array:
        shown = ", ".join(f"{part:.1%} {label}" for label, part in reports[0]["shown"].items())
        tiles = f"{reports[0]['tiles']:,} tiles"
        print(f"{reports[0]['shape']}: {tiles}; after {_steps(args.steps)} they show {shown}")
    else:
        rows = [
            [
                report["shape"],
                report["file"],
                f"{report['runs']}",
                f"{report['cells_right']:.4f}",
                f"{report['total_agreement']:.4f}",
                *("never" if t is None else f"{t:.0f}" for t in report["steps_to_agreement"].values()),
            ]
            for report in reports
        ]
        print(table(("shape", "file", "runs", "cells right", "all right", "median", "95 %"), rows))
    speed, threads = _speed(reports), args.threads or processors()
    print(
        f"{speed['cell_updates']:,} cell updates in {speed['seconds']:.2f} s, "
        f"{speed['updates_per_second'] / 1e6:.2f} million per second; threads: at most {threads}"
    )


def _steps(count: int) -> str:
    return "1 step" if count == 1 else f"{count} steps"


def picture_of(shape: Shape, labels: tuple[str, ...], shown: NDArray[np.int8]) -> Picture:
    """The drawing with the class that each tile shows, `DARK` for none."""
    looks = [DARK_LOOK if k == DARK else look_of_class(labels, int(k)) for k in shown]
    return Picture(shape, tuple(look.segments for look in looks), tuple(look.colour for look in looks))


def _watch(simulator: Simulator, shape: Shape, labels: tuple[str, ...], steps: int) -> None:
    """Runs at the pace of real tiles, and shows it; one plain line per change where there is no terminal."""
    console = Console(highlight=False)
    started_s = time.monotonic()
    with ExitStack() as stack:
        live = stack.enter_context(Live(console=console, auto_refresh=False)) if console.is_terminal else None
        for step in range(1, steps + 1):
            before = simulator.shown.copy()
            right = float(simulator.run(1).right[0, 0])
            if live is not None:
                picture = picture_of(shape, labels, simulator.shown)
                ascii_only, room = console.options.ascii_only, console.height - 2
                tiles = fitting(picture, console.width, room, ascii_only, labels)
                caption = Text(
                    f"{shape.name}: {right:.0%} of the tiles show {shape.label}   step {step}", "bold"
                )
                live.update(Group(*tiles, caption), refresh=True)
                time.sleep(max(0.0, started_s + step * STEP_S - time.monotonic()))
            else:
                for tile in np.flatnonzero(simulator.shown != before):
                    now = simulator.shown[tile]
                    what = "nothing" if now == DARK else labels[now]
                    print(f"step {step:4}  {shape.name}: tile {tile + 1} shows {what}")
    print(f"{shape.name}: {right:.0%} of the living tiles show {shape.label} after {_steps(steps)}")
