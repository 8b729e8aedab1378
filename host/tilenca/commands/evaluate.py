"""`tilenca evaluate`: how well a model does on shapes."""

import argparse
import json
import threading
from dataclasses import replace

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
    number,
    seed,
    size,
)
from tilenca.commands.emulate_options import MAX_BOOT_SPREAD_S
from tilenca.commands.evaluate_results import RunResults, print_report, report_of
from tilenca.commands.origin import shapes_or_own
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.side_by_side import run_side_by_side
from tilenca.evaluation.evaluator import CONVERGED_BY
from tilenca.evaluation.suites import make_suite, recorded_aims
from tilenca.evaluation.validation import validate
from tilenca.model.cost import firmware_period_ms
from tilenca.model.file import Model, load_model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.protocol.line_reader import Heard
from tilenca.shapes.batch import Drawings, load_drawings, load_training_task
from tilenca.shapes.file import too_large
from tilenca.shapes.sizes import Size, size_name
from tilenca.simulator.conditions import AS_TILES, Conditions, latency_of
from tilenca.simulator.engine import Engine, FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.simulator.tile_times import DRIFT
from tilenca.sweep.axes import STEP_S
from tilenca.sweep.emulated import PLUGS, EmulatedRun, Image, plugged, run_emulated
from tilenca.views.progress import show_progress

# Options that --suite does not take, and their defaults.
FIXED_BY_SUITE = {
    "engine": "fast",
    "schedule": "clock",
    "steps": CONVERGED_BY,
    "size": None,
    "loss": 0.0,
    "lost": "held",
    "dead": 0.0,
    "plug": None,
    "boot_spread": None,
    "latency": None,
}
RUNS = {"fast": 100, "float": 100, "emulator": 1}


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
    parser.add_argument(
        "--plug",
        choices=PLUGS,
        help="emulator: in each run a tile is plugged in while the others run, and steps and times count "
        "from then: one that was pulled before (again), or that was never there (new)",
    )
    add_condition_arguments(parser)
    parser.add_argument(
        "--boot-spread",
        type=number(0.0, MAX_BOOT_SPREAD_S),
        metavar="S",
        help="tiles are switched on within 0..S seconds (fast: 0.2; emulator: 1.0)",
    )
    parser.add_argument(
        "--latency",
        metavar="L",
        help="fast: what a message takes, in periods, such as 0.5, or each tile's between 0.1-0.9 (0.1-0.9); "
        f"{AS_TILES}: what it takes on tiles, by its side",
    )
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
    elif args.plug is not None:
        raise UsageError("--plug is for emulated tiles; add --engine emulator")
    else:
        conditions = _conditions(args, model)
        random = np.random.default_rng(args.seed)
        simulator = Simulator(_engine(args.engine, model), drawings, chosen, conditions, random)
        trajectory = simulator.run(args.steps)
        regressed = ~trajectory.agreed[CONVERGED_BY - 1 :].all(axis=0) & (args.steps > CONVERGED_BY)
        outcome = RunResults(
            chosen, trajectory.right[-1], trajectory.converged_at, regressed, simulator.answers()
        )
    report = report_of(args, model, drawings, runs, outcome)
    if args.json:
        print(json.dumps(report))
    else:
        print_report(report)
    return 0


def _run_suite(args: argparse.Namespace, model: Model) -> int:
    """The measurements of the model card; the same seed and number of runs repeat them."""
    for option, usual in FIXED_BY_SUITE.items():
        if getattr(args, option) != usual:
            raise UsageError(f"--suite sets its own conditions; leave --{option.replace('_', '-')} out")
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


def _conditions(args: argparse.Namespace, model: Model) -> Conditions:
    """Of simulated runs."""
    usual = Conditions(args.schedule, loss=args.loss, lost=args.lost, dead=args.dead)
    if args.boot_spread is not None:
        usual = replace(usual, boot=args.boot_spread / STEP_S)
    if args.latency is None:
        return usual
    drift = DRIFT if args.latency == AS_TILES else usual.drift
    try:
        latency = latency_of(args.latency, model.dimensions, firmware_period_ms())
        return replace(usual, latency=latency, drift=drift)
    except ValueError as error:
        raise UsageError(f"--latency: {error}") from error


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
    if args.schedule != "clock" or args.loss or args.dead or args.latency:
        raise UsageError(
            "--engine emulator runs tiles as they are: on their clocks, no --loss, no --dead, no --latency"
        )
    if args.plug and args.boot_spread is not None:
        raise UsageError("--plug: the others are switched on within its own time; leave --boot-spread out")
    if (remedy := too_large(drawings.shapes)) is not None:
        raise UsageError(f"--engine emulator: {remedy}")
    beside = paths.model_elf(args.model)
    elf = beside if beside.exists() else firmware_image()
    if not elf.exists():
        raise BuildError(f"{elf}: no firmware image; {build_remedy()}")
    image = Image(elf, firmware_settings(elf), model, args.model)
    period_ms = image.defaults.period_ms if image.defaults else DEFAULT_PERIOD_MS
    if args.plug and (alone := [shape.name for shape in drawings.shapes if len(shape.cells) == 1]):
        raise UsageError(f"--plug: '{alone[0]}' has one tile, and no others; leave it out")

    def run(number: int, stopped: threading.Event) -> EmulatedRun:
        shape = drawings.shapes[chosen[number]]
        settings = EmulationSettings(updates=args.steps, seed=args.seed * 1000 + number)
        if args.boot_spread is not None:
            settings = replace(settings, boot_spread_s=args.boot_spread)
        if args.plug:
            settings = plugged(settings, args.plug, len(shape.cells), args.steps, period_ms)

        def look(running: Emulation, _: list[Heard]) -> None:
            tell(f"{shape.name}, run {number + 1}", running.share_done(), f"of {len(chosen)}")
            if stopped.is_set():
                raise KeyboardInterrupt

        return run_emulated(image, shape, settings, look)

    with show_progress() as tell:
        results = [result for _, result in run_side_by_side(run, range(len(chosen)))]
    right = np.array([result.right for result in results], np.float32)
    converged_at = np.array([result.converged_at for result in results])
    agreed_s = np.array([result.agreed_s for result in results])
    return RunResults(chosen, right, converged_at, np.zeros(len(chosen), np.bool_), agreed_s=agreed_s)
