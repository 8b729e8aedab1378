"""`tilenca emulate`: the firmware image on one emulated board per tile, wired as on the real board."""

import argparse
import json
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from rich.console import Console
from rich.live import Live

from tilenca import paths
from tilenca.emulate_serve import STOCK_BOOTLOADER, serve
from tilenca.emulate_view import Picture, beside, take_picture, verdict
from tilenca.emulation import Conditions, Emulation, firmware_settings
from tilenca.errors import BuildError, UsageError
from tilenca.protocol import MAX_PERIOD_MS, MIN_PERIOD_MS, Settings
from tilenca.recording import format_event
from tilenca.shapes import Shape, Task, load_task
from tilenca.telemetry import Heard

ALL = "all"
WORKERS = 2
MAX_TILES = 255  # a tile's number is one byte
PLAIN_WIDTH = 80
DEFAULT_UPDATES = 30
NO_BOOTLOADER = "none"

Listener = Callable[[Emulation, list[Heard]], None]


@dataclass(frozen=True)
class Outcome:
    """A shape that has run to its end."""

    report: dict[str, Any]
    picture: Picture
    verdict: str
    warnings: tuple[str, ...]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add = parser.add_argument
    add("--shape", action="append", metavar="NAME", help="a shape of the file; again for more (default: all)")
    add(
        "--shapes",
        type=Path,
        default=paths.DEFAULT_SHAPES,
        metavar="F",
        help="shape file (shapes/digits.toml)",
    )
    add("--elf", type=Path, default=paths.FIRMWARE_ELF, metavar="F", help="firmware image (the last build's)")
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--seconds", type=_positive, metavar="S", help="run for S emulated seconds")
    length.add_argument(
        "--updates", type=_count, metavar="N", help=f"run until every tile did N updates ({DEFAULT_UPDATES})"
    )
    add("--period-ms", type=_period, metavar="N", help="update period of the tiles (the firmware's default)")
    add("--ppm", type=_not_negative, default=3000.0, metavar="X", help="clock errors within +-X ppm (3000)")
    add(
        "--boot-spread",
        type=_not_negative,
        default=1.0,
        metavar="S",
        help="switched on within 0..S seconds (1.0)",
    )
    add("--seed", type=int, default=0, metavar="N", help="decides clock errors and switch-on times (0)")
    add("--record", type=Path, metavar="F", help="write all telemetry to F, one JSON object per line")
    add("--json", action="store_true", help="one JSON document on stdout")
    look = parser.add_mutually_exclusive_group()
    look.add_argument("--watch", action="store_true", help="show the tiles while they run, in real time")
    look.add_argument(
        "--serve", type=Path, metavar="DIR", help="give each tile's USB serial as DIR/tile-01, ..."
    )
    add("--bootloader", metavar="F", help="with --serve: image of the boot section, or none (the stock one)")
    add("--keep-running", action="store_true", help="with --serve: opening a port does not reset its tile")


def _number(text: str, lowest: float) -> float:
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not lowest <= number < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number from {lowest:g}")
    return number


def _not_negative(text: str) -> float:
    return _number(text, 0.0)


def _positive(text: str) -> float:
    return _number(text, 0.001)


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1")
    return int(text)


def _period(text: str) -> int:
    if not text.isdecimal() or not MIN_PERIOD_MS <= int(text) <= MAX_PERIOD_MS:
        raise argparse.ArgumentTypeError(f"'{text}' is not {MIN_PERIOD_MS} to {MAX_PERIOD_MS} milliseconds")
    return int(text)


def run(args: argparse.Namespace) -> int:
    """Runs the command; 1 when a tile of any shape ends up wrong."""
    task = load_task(args.shapes)
    shapes = _chosen(task, args.shape or [ALL])
    if not args.elf.exists():
        raise BuildError(f"{args.elf}: no firmware image; run `make demo` or `pio run`, or give --elf")
    defaults = firmware_settings(args.elf)
    conditions = Conditions(
        args.seconds, args.updates or DEFAULT_UPDATES, args.period_ms, args.ppm, args.boot_spread, args.seed
    )
    if args.serve is not None:
        return _serve(args, task, shapes, conditions, defaults)
    with ExitStack() as stack:
        record = stack.enter_context(_open_record(args.record)) if args.record else None
        if args.watch and not args.json:
            outcomes = [_watch(task, shape, args.elf, conditions, defaults, record) for shape in shapes]
        else:
            outcomes = _run_all(task, shapes, args.elf, conditions, defaults, record)
    for warning in sorted({warning for outcome in outcomes for warning in outcome.warnings}):
        print(f"tilenca: not emulated: {warning}", file=sys.stderr)
    _print(args, outcomes)
    return 0 if all(outcome.report["all_right"] for outcome in outcomes) else 1


def _chosen(task: Task, names: Sequence[str]) -> list[Shape]:
    chosen = list(task.shapes) if ALL in names else [task.find(name) for name in dict.fromkeys(names)]
    for shape in chosen:
        if len(shape.cells) > MAX_TILES:
            raise UsageError(
                f"{task.path}: shape '{shape.name}' has {len(shape.cells)} tiles; at most {MAX_TILES}"
            )
    return chosen


def _open_record(path: Path) -> TextIO:
    try:
        return path.open("w", encoding="ascii")
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give --record a file that can be written") from error


def _write_record(record: TextIO, shape: Shape, heard: Sequence[Heard]) -> None:
    for line in heard:
        about = json.loads(format_event(line))
        tile = int(line.port.rsplit("-", 1)[1])
        record.write(json.dumps({**about, "tile": tile, "shape": shape.name}) + "\n")


def _outcome(emulation: Emulation, started: float) -> Outcome:
    warnings = tuple(warning for tile in emulation.array for warning in tile.warnings)
    report = emulation.report(time.monotonic() - started)
    return Outcome(report, take_picture(emulation), verdict(emulation), warnings)


def _run_all(
    task: Task, shapes: Sequence[Shape], elf: Path, conditions: Conditions, defaults: Settings | None,
    record: TextIO | None,
) -> list[Outcome]:  # fmt: skip
    """Runs shapes side by side, since they know nothing of each other; results come in their order."""
    stopped = threading.Event()

    def one(shape: Shape) -> tuple[Outcome, list[Heard]]:
        started = time.monotonic()
        kept: list[Heard] = []

        def keep(_: Emulation, heard: list[Heard]) -> None:
            if stopped.is_set():
                raise KeyboardInterrupt
            if record is not None:
                kept.extend(heard)

        emulation = Emulation(task, shape, elf, conditions, defaults)
        with emulation.array:
            emulation.run(keep)
            return _outcome(emulation, started), kept

    outcomes = []
    with ThreadPoolExecutor(min(WORKERS, os.cpu_count() or 1)) as pool:
        try:
            for shape, (outcome, heard) in zip(shapes, pool.map(one, shapes), strict=True):
                outcomes.append(outcome)
                speed = outcome.report["simulated_s"] / max(outcome.report["wall_s"], 0.001)
                print(f"{outcome.verdict} [{speed:.1f} times real time]", file=sys.stderr)
                if record is not None:
                    _write_record(record, shape, heard)
        except BaseException:
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return outcomes


def _watch(
    task: Task,
    shape: Shape,
    elf: Path,
    conditions: Conditions,
    defaults: Settings | None,
    record: TextIO | None,
) -> Outcome:
    """Runs one shape in step with the wall clock, or slower, and shows it."""
    console = Console()
    started = time.monotonic()
    emulation = Emulation(task, shape, elf, conditions, defaults)
    told = [0] * len(emulation.array)
    with emulation.array, ExitStack() as stack:
        live = stack.enter_context(Live(console=console, auto_refresh=False)) if console.is_terminal else None

        def show(running: Emulation, heard: list[Heard]) -> None:
            if record is not None:
                _write_record(record, shape, heard)
            if live is not None:
                live.update(beside([take_picture(running)], console.width), refresh=True)
                time.sleep(max(0.0, started + running.array.time_s - time.monotonic()))
            else:
                _tell_changes(running, told)

        emulation.run(show)
        return _outcome(emulation, started)


def _tell_changes(emulation: Emulation, told: list[int]) -> None:
    """One plain line for every change of a display, for what is not a terminal."""
    for tile in emulation.array:
        for change in tile.display_changes[told[tile.index] :]:
            told[tile.index] += 1
            shown = emulation.label(change.segments) or "nothing"
            print(f"{change.time_s:8.3f} s  {emulation.shape.name}: tile {tile.index + 1} shows {shown}")


def _serve(
    args: argparse.Namespace,
    task: Task,
    shapes: Sequence[Shape],
    conditions: Conditions,
    defaults: Settings | None,
) -> int:
    if len(shapes) != 1:
        raise UsageError(f"--serve needs one shape, got {len(shapes)}; give --shape NAME")
    bootloader = _bootloader(args.bootloader)
    settled = Conditions(**{**vars(conditions), "bootloader": bootloader})
    emulation = Emulation(task, shapes[0], args.elf, settled, defaults)
    with emulation.array:
        serve(emulation, args.serve, args.seconds, reset_on_open=not args.keep_running)
    return 0


def _bootloader(given: str | None) -> Path | None:
    if given is None:
        return STOCK_BOOTLOADER if STOCK_BOOTLOADER.exists() else None
    return None if given == NO_BOOTLOADER else Path(given)


def _print(args: argparse.Namespace, outcomes: Sequence[Outcome]) -> None:
    all_right = all(outcome.report["all_right"] for outcome in outcomes)
    if args.json:
        reports = [outcome.report for outcome in outcomes]
        print(json.dumps(reports[0] if len(reports) == 1 else {"runs": reports, "all_right": all_right}))
        return
    console = Console(highlight=False)
    if not (args.watch and console.is_terminal):  # there the last picture still stands
        width = console.width if console.is_terminal else PLAIN_WIDTH
        console.print(beside([outcome.picture for outcome in outcomes], width))
    for outcome in outcomes:
        console.print(outcome.verdict, soft_wrap=True, markup=False)
    right = sum(outcome.report["all_right"] for outcome in outcomes)
    emulated_s = sum(outcome.report["simulated_s"] for outcome in outcomes)
    tiles = sum(len(outcome.report["tiles"]) for outcome in outcomes)
    console.print(
        f"{right} of {len(outcomes)} shapes right; {tiles} tiles, {emulated_s:.1f} s emulated", soft_wrap=True
    )
