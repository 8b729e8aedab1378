"""`tilenca evaluate`: how well a model does on shapes."""

import argparse
import json
import threading
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError
from tilenca.base.project import build_remedy, firmware_image, install_remedy
from tilenca.commands.arguments import (
    OWN_SHAPES,
    add_condition_arguments,
    add_model_argument,
    add_shapes_argument,
    count,
    seed,
    size,
)
from tilenca.commands.origin import shapes_or_own
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.side_by_side import run_side_by_side
from tilenca.evaluation.evaluator import CONVERGED_BY
from tilenca.evaluation.metrics import answer_shares, convergence_times
from tilenca.evaluation.suites import make_suite, recorded_aims
from tilenca.evaluation.validation import validate
from tilenca.model.file import Model, load_model
from tilenca.protocol.line_reader import Heard
from tilenca.shapes.batch import Drawings, load_drawings, load_training_task
from tilenca.shapes.file import too_large
from tilenca.shapes.sizes import Size, size_name
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import Engine, FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.sweep.emulated import EmulatedRun, Image, run_emulated
from tilenca.views.progress import show_progress
from tilenca.views.table import table

# Options that --suite does not take, and their defaults.
FIXED_BY_SUITE = {
    "engine": "fast",
    "schedule": "clock",
    "steps": CONVERGED_BY,
    "size": None,
    "loss": 0.0,
    "lost": "held",
    "dead": 0.0,
}
RUNS = {"fast": 100, "float": 100, "emulator": 1}


@dataclass(frozen=True)
class RunResults:
    """The measured runs, one entry per run.

    Attributes:
        chosen: (R,) the drawing.
        right: (R,) share of tiles that show the right class at the end.
        converged_at: (R,) step from which all were right to the end; infinite for none.
        regressed: (R,) whether a tile was wrong after step 60, in runs longer than that.
        answers: (R,) what all tiles showed at the end, see `Simulator.answers`; None: not measured.
    """

    chosen: NDArray[np.int64]
    right: NDArray[np.float32]
    converged_at: NDArray[np.float64]
    regressed: NDArray[np.bool_]
    answers: NDArray[np.int64] | None = None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    add_model_argument(parser)
    add_shapes_argument(parser.add_argument, "shape files", OWN_SHAPES, nargs="+")
    parser.add_argument(
        "--engine",
        choices=tuple(RUNS),
        default="fast",
        help="fast: the firmware's core on this machine; float: the PyTorch model; emulator: the ELF",
    )
    parser.add_argument(
        "--steps", type=count, default=CONVERGED_BY, metavar="N", help=f"updates per tile ({CONVERGED_BY})"
    )
    parser.add_argument("--runs", type=count, metavar="N", help="runs per drawing (100; emulator: 1)")
    parser.add_argument(
        "--size",
        type=size,
        metavar="RxC",
        help="stretch the drawings to so many rows and columns, like 9x7",
    )
    parser.add_argument(
        "--suite",
        action="store_true",
        help="run the test suite of the model card: sizes, loss, damage, changes, unknown shapes, long runs",
    )
    parser.add_argument(
        "--exam", dest="suite", action="store_true", help=argparse.SUPPRESS
    )  # its name in 0.1
    parser.add_argument(
        "--row",
        action="append",
        default=[],
        metavar="TEXT",
        help="of the suite, only rows with this in their name, or =NAME for one row; again for more",
    )
    add_condition_arguments(parser)
    parser.add_argument(
        "--seed", type=seed, default=1, metavar="N", help="same seed, same numbers (default 1)"
    )
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Measures and prints."""
    runs = RUNS[args.engine] if args.runs is None else args.runs
    model = load_model(args.model)
    args.shapes = shapes_or_own(args.shapes, model, args.model)
    if args.suite:
        return _run_suite(args, model)
    if args.row:
        raise UsageError("--row chooses rows of the suite; add --suite")
    drawings = load_drawings(args.shapes, labels=model.labels)
    if args.size is not None:
        drawings = _at_size(drawings, args.size)
    chosen = np.repeat(np.arange(len(drawings)), runs)
    if args.engine == "emulator":
        outcome = _emulate(args, model, drawings, chosen)
    else:
        conditions = Conditions(args.schedule, loss=args.loss, lost=args.lost, dead=args.dead)
        random = np.random.default_rng(args.seed)
        simulator = Simulator(_engine(args.engine, model), drawings, chosen, conditions, random)
        trajectory = simulator.run(args.steps)
        regressed = ~trajectory.agreed[CONVERGED_BY - 1 :].all(axis=0) & (args.steps > CONVERGED_BY)
        outcome = RunResults(
            chosen, trajectory.right[-1], trajectory.converged_at, regressed, simulator.answers()
        )
    report = _report(args, model, drawings, runs, outcome)
    if args.json:
        print(json.dumps(report))
    else:
        _print(report)
    return 0


def _run_suite(args: argparse.Namespace, model: Model) -> int:
    """The measurements of the model card; the same seed and number of runs repeat them."""
    for option, usual in FIXED_BY_SUITE.items():
        if getattr(args, option) != usual:
            raise UsageError(f"--suite sets its own conditions; leave --{option} out")
    aims = recorded_aims(model)
    task, sizes = load_training_task(args.shapes, aims.stretch, model.dimensions.max_classes, model.labels)
    suite = make_suite(task, sizes, model.labels, aims, args.seed)
    say = (lambda _: None) if args.json else print
    metrics = validate(FastEngine(model), suite, args.runs or RUNS["fast"], args.seed, say, args.row)
    if not metrics["rows"]:
        raise UsageError(
            f"no row of the suite has {' or '.join(map(repr, args.row))} in its name; "
            "leave --row out to see all"
        )
    if args.json:
        print(json.dumps({"model": f"{model.model_id:04X}", "metrics": metrics}))
    else:
        print(f"{metrics['targets_held']} targets held")
    return 0


def _at_size(drawings: Drawings, wanted: Size) -> Drawings:
    """The drawings that can be drawn at that size."""
    found = [
        (other, group)
        for shape, group in zip(drawings.shapes, drawings.groups, strict=True)
        if (other := shape.stretched(wanted)) is not None
    ]
    if not found:
        raise UsageError(f"--size {size_name(wanted)}: no drawing can be drawn that small; give a larger one")
    shapes, groups = zip(*found, strict=True)
    return replace(drawings, shapes=shapes, groups=groups)


def _engine(name: str, model: Model) -> Engine:
    if name == "fast":
        return FastEngine(model)
    try:
        from tilenca.training.float_engine import FloatEngine
    except ImportError as error:
        raise UsageError(
            f"--engine float needs PyTorch; use --engine fast, or run: {install_remedy('train')}"
        ) from error
    return FloatEngine(model)


def _emulate(
    args: argparse.Namespace, model: Model, drawings: Drawings, chosen: NDArray[np.int64]
) -> RunResults:
    """Runs the firmware image, one emulation for each entry of `chosen`."""
    if args.schedule != "clock" or args.loss or args.dead:
        raise UsageError("--engine emulator runs tiles as they are: on their clocks, no --loss, no --dead")
    if (remedy := too_large(drawings.shapes)) is not None:
        raise UsageError(f"--engine emulator: {remedy}")
    beside = paths.model_elf(args.model)
    elf = beside if beside.exists() else firmware_image()
    if not elf.exists():
        raise BuildError(f"{elf}: no firmware image; {build_remedy()}")
    image = Image(elf, firmware_settings(elf), model, args.model)

    def run(number: int, stopped: threading.Event) -> EmulatedRun:
        shape = drawings.shapes[chosen[number]]
        settings = EmulationSettings(updates=args.steps, seed=args.seed * 1000 + number)

        def look(running: Emulation, _: list[Heard]) -> None:
            tell(f"{shape.name}, run {number + 1}", running.share_done(), f"of {len(chosen)}")
            if stopped.is_set():
                raise KeyboardInterrupt

        return run_emulated(image, shape, settings, look)

    with show_progress() as tell:
        results = [result for _, result in run_side_by_side(run, range(len(chosen)))]
    right = np.array([result.right for result in results], np.float32)
    converged_at = np.array([result.converged_at for result in results])
    return RunResults(chosen, right, converged_at, np.zeros(len(chosen), np.bool_))


def _report(
    args: argparse.Namespace, model: Model, drawings: Drawings, runs: int, outcome: RunResults
) -> dict[str, Any]:
    agreed = outcome.right >= 1.0
    per_shape = []
    for number, shape in enumerate(drawings.shapes):
        mine = outcome.chosen == number
        per_shape.append(
            {
                "label": shape.label,
                "name": shape.name,
                "file": drawings.sources[drawings.groups[number]]["file"],
                "grid": shape.grid,
                "cells_right": round(float(outcome.right[mine].mean()), 6),
                "total_agreement": round(float(agreed[mine].mean()), 6),
                "steps_to_agreement": convergence_times(outcome.converged_at[mine]),
            }
        )
    return {
        "model": f"{model.model_id:04X}",
        "engine": args.engine,
        "schedule": args.schedule,
        "steps": args.steps,
        "runs": runs,
        "cells_right": round(float(outcome.right.mean()), 6),
        "total_agreement": round(float(agreed.mean()), 6),
        "missed": _missed(drawings, outcome),
        "steps_to_agreement": convergence_times(outcome.converged_at),
        "runs_with_a_regression": int(outcome.regressed.sum()),
        "per_shape": per_shape,
    }


def _missed(drawings: Drawings, outcome: RunResults) -> dict[str, float] | None:
    """The shares of the runs in which all tiles show the dash, all another class, or tiles differ."""
    if outcome.answers is None:
        return None
    shares = answer_shares(drawings, outcome.chosen, outcome.answers)
    return dict(zip(("dash", "wrong", "split"), shares, strict=True))


def _print(report: dict[str, Any]) -> None:
    def texts(times: dict[str, float | None]) -> list[str]:
        return ["never" if value is None else f"{value:.0f}" for value in times.values()]

    def cells(name: str, file: str, row: dict[str, Any]) -> list[str]:
        shares = f"{row['cells_right']:.4f}", f"{row['total_agreement']:.4f}"
        return [name, file, *shares, *texts(row["steps_to_agreement"])]

    rows = [cells(row["name"], row["file"], row) for row in report["per_shape"]]
    rows.append(cells("all", "", report))
    print(
        f"model {report['model']}, engine {report['engine']}, schedule {report['schedule']}: after "
        f"{report['steps']} steps, {report['runs']} runs per shape; median and 95 %: steps until all tiles "
        "are right and stay so"
    )
    print(table(("shape", "file", "cells right", "all right", "median", "95 %"), rows))
    if report["missed"] is not None:
        shares = ", ".join(f"{kind} {share:.4f}" for kind, share in report["missed"].items())
        print(f"not right: {shares} of the runs; split: tiles of one body show different answers")
