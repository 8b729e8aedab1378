"""`tilenca sweep`: scores over every combination of conditions, on many cores."""

import argparse
import json
import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tilenca import __version__
from tilenca.base import paths
from tilenca.base.errors import BuildError, InterruptedRunError, UsageError
from tilenca.base.processors import processors
from tilenca.base.project import build_remedy, firmware_image, place_of
from tilenca.base.signals import promising
from tilenca.base.stdio import warn
from tilenca.commands.arguments import (
    add_cluster_arguments,
    add_shapes_argument,
    count,
    seed,
)
from tilenca.sweep.axes import AXES, EMULATOR, ENGINES, EXAMPLE, FAST, parse_axis, text_of
from tilenca.views.progress import show_bars
from tilenca.views.table import table

if TYPE_CHECKING:
    from tilenca.sweep.plan import Plan, Wish
    from tilenca.sweep.rows import Row
    from tilenca.sweep.run import Progress

RUNS = {FAST: 100, EMULATOR: 10}
MOST_SHOWN = 60  # cells that are printed
KEEPING = "keeps what was measured; the same command goes on from there"
LINES = 10  # of progress, where there is no terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add = parser.add_argument
    add(
        "--axis",
        action="append",
        default=[],
        type=parse_axis,
        metavar="NAME=VALUES",
        help=f"what to vary, such as {EXAMPLE}; again for more: every combination is measured. "
        f"Axes: {', '.join(AXES)}",
    )
    add("--model", default="digits", metavar="DIR", help="the model's directory, or its short name (digits)")
    add_shapes_argument(add, "shape files", nargs="+", default=[paths.DEFAULT_SHAPES])
    add("--shape", action="append", default=[], metavar="NAME", help="only this drawing; again for more")
    add(
        "--engine",
        choices=ENGINES,
        default=FAST,
        help="fast: the firmware's core on each machine; emulator: the ELF on emulated tiles",
    )
    add(
        "--steps",
        type=count,
        metavar="N",
        help="updates per tile (as the test suite: 60, more for large sizes)",
    )
    add(
        "--runs", type=count, metavar="N", help="runs of each drawing in each combination (100; emulator: 10)"
    )
    add("--seed", type=seed, default=1, metavar="N", help="same seed, same table (1)")
    add(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="where the table goes, and what is measured so far",
    )
    add_cluster_arguments(parser)
    add("--csv", action="store_true", help="write the table as CSV, too")
    add("--plot", action="store_true", help="draw curves with intervals, and heat maps")
    add("--json", action="store_true", help="print the rows as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Measures what the folder does not have yet, and writes the table."""
    started = time.monotonic()
    from tilenca.sweep.journal import Journal
    from tilenca.sweep.plan import make_plan
    from tilenca.sweep.table import identity_text, rows_of, write_csv, write_parquet

    wish = _wish(args)
    plan = make_plan(wish)
    command = _command(args, wish)
    with closing(
        Journal(args.out, plan.identity, f"{command} --out {shlex.quote(str(args.out))}")
    ) as journal:
        progress = _measure(args, plan, journal)
        rows = rows_of(plan, journal.counts, lambda row, whole: _row_command(wish, row, whole))
    about = {"version": __version__, "command": command, "identity": identity_text(plan.identity)}
    files = [write_parquet(args.out, rows, about)]
    if args.csv:
        files.append(write_csv(args.out, rows))
    if args.plot:
        from tilenca.views.sweep import draw_sweep

        files += draw_sweep(rows, [axis.name for axis in wish.axes if len(axis.values) > 1], args.out)
    _tell_speed(progress, time.monotonic() - started)
    _print(args, wish, rows, files)
    return 0


def _wish(args: argparse.Namespace) -> "Wish":
    from tilenca.sweep.plan import Wish

    if any(axis.name == "model" for axis in args.axis) and args.model != "digits":
        raise UsageError("--model does nothing with --axis model; leave it out")
    image = None
    if args.engine == EMULATOR:
        image = firmware_image()
        if not image.exists():
            raise BuildError(f"{image}: no firmware image; {build_remedy()}")
    return Wish(
        tuple(args.axis),
        args.model,
        tuple(args.shapes),
        args.engine,
        args.steps,
        args.runs or RUNS[args.engine],
        args.seed,
        tuple(args.shape),
        image,
    )


def _measure(args: argparse.Namespace, plan: "Plan", journal: Any) -> "Progress":
    """Runs what is missing; without anything missing no cluster is asked for."""
    from tilenca.sweep.run import progress_of, run_sweep

    progress, missing = progress_of(plan, journal)
    if not missing:
        return progress
    from tilenca.cluster.client import open_cluster
    from tilenca.sweep.measure import check_emulator, check_simulator

    check = check_emulator if args.engine == EMULATOR else check_simulator
    try:
        with open_cluster(args.scheduler, args.jobs or processors(), check) as cluster:
            _announce(plan, progress, cluster)
            with _shown(cluster) as tell, promising(KEEPING):
                return run_sweep(plan, journal, cluster, tell)
    except KeyboardInterrupt:
        progress, _ = progress_of(plan, journal)
        raise InterruptedRunError(
            f"interrupted; {args.out} has {progress.done:,} of {progress.runs:,} runs; to go on, run the "
            "same command again"
        ) from None


def _announce(plan: "Plan", progress: "Progress", cluster: Any) -> None:
    had = f", {progress.done:,} of them measured before" if progress.done else ""
    warn(
        f"{len(plan.cells):,} cells, {len(plan.rows):,} drawings in them, {progress.runs:,} runs{had}; "
        f"{cluster.workers()} workers{cluster.dashboard()}"
    )


@contextmanager
def _shown(cluster: Any) -> "Iterator[Any]":
    """Shows progress: a bar on a terminal, some lines elsewhere."""
    from rich.console import Console

    console = Console(stderr=True)
    printed, counted, workers = 0, 0.0, 0
    with show_bars(console, transient=True) as bars:

        def tell(progress: "Progress") -> None:
            nonlocal printed, counted, workers
            if "sweep" not in bars:
                bars.add("sweep", "sweep", progress.runs)
                printed = progress.done * LINES // progress.runs
            if time.monotonic() - counted > 1.0 and cluster.connected:
                counted, workers = time.monotonic(), cluster.workers()
            note = f"{progress.done:,} of {progress.runs:,} runs, {workers} workers"
            bars.move("sweep", progress.done, note)
            if not console.is_terminal and progress.done * LINES // progress.runs > printed:
                printed = progress.done * LINES // progress.runs
                print(note, file=sys.stderr, flush=True)

        yield tell


def _tell_speed(progress: "Progress", seconds: float) -> None:
    if progress.updates:
        rate = progress.updates / max(progress.cpu_s, 1e-6) / 1e6
        warn(
            f"{progress.updates:,} cell updates in {seconds:.1f} s; the workers computed for "
            f"{progress.cpu_s:.1f} s, {rate:.2f} million updates in each"
        )


def _command(args: argparse.Namespace, wish: "Wish") -> str:
    """The command that makes the same table, without the place of its files."""
    axes = [f"{axis.name}={','.join(map(text_of, axis.values))}" for axis in wish.axes]
    return shlex.join(_words(wish, axes, wish.only))


def _row_command(wish: "Wish", row: "Row", whole: bool) -> str:
    """The command that measures a row again, or the whole cell that it is in."""
    axes = [f"{axis.name}={text_of(row.point[axis.name])}" for axis in wish.axes]
    return shlex.join([*_words(wish, axes, wish.only if whole else (row.subject.name,)), "--out", "row"])


def _words(wish: "Wish", axes: list[str], only: tuple[str, ...]) -> list[str]:
    words = ["tilenca", "sweep", *(word for axis in axes for word in ("--axis", axis))]
    if all(axis.name != "model" for axis in wish.axes):
        words += ["--model", wish.model]
    words += ["--shapes", *map(place_of, wish.files)]
    words += [word for name in only for word in ("--shape", name)]
    words += ["--engine", wish.engine, "--runs", str(wish.runs), "--seed", str(wish.seed)]
    return words if wish.steps is None else [*words, "--steps", str(wish.steps)]


def _print(args: argparse.Namespace, wish: "Wish", rows: list[dict[str, Any]], files: list[Path]) -> None:
    if args.json:
        print(json.dumps({"rows": rows, "files": [str(path) for path in files]}))
        return
    from tilenca.sweep.table import ALL

    last = [row for row, after in zip(rows, [*rows[1:], None], strict=True) if _ends_cell(row, after, wish)]
    names = [axis.name for axis in wish.axes if len(axis.values) > 1]
    if len(last) <= MOST_SHOWN:
        header = [*names, "runs", "all right", "95 % interval", "cells right", "median", "95 %"]
        print(table(header, [_texts(row, names) for row in last]))
    else:
        print(f"{len(last):,} cells; their last rows have shape '{ALL}'")
    for path in files:
        print(path)


def _ends_cell(row: dict[str, Any], after: dict[str, Any] | None, wish: "Wish") -> bool:
    """Whether a row is the last one of its cell, which has all its drawings."""
    names = [axis.name.replace("-", "_") for axis in wish.axes]
    return after is None or any(row[name] != after[name] for name in names)


def _texts(row: dict[str, Any], names: list[str]) -> list[str]:
    values = [text_of(row[name.replace("-", "_")]) for name in names]
    times = ["never" if row[name] is None else f"{row[name]:.0f}" for name in ("median", "p95")]
    interval = f"{row['low']:.4f} to {row['high']:.4f}"
    return [*values, f"{row['runs']}", f"{row['share']:.4f}", interval, f"{row['cells_right']:.4f}", *times]
