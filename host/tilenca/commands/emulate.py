"""`tilenca emulate`: the firmware image on one emulated board per tile, wired as on the real board."""

import argparse
import json
import os
import stat
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.live import Live

from tilenca.base import paths
from tilenca.base.errors import UsageError, image_error
from tilenca.base.stdio import warn
from tilenca.commands.arguments import count, number, seed, size, whole
from tilenca.emulator.debug import attend, debuggers, frames, waveforms
from tilenca.emulator.experiment import Emulation, EmulationSettings, firmware_settings, save_eeprom
from tilenca.emulator.faults import parse as parse_fault
from tilenca.emulator.serve import STOCK_BOOTLOADER, serve
from tilenca.fleet.recording import Recorder, as_record
from tilenca.protocol.constants import MAX_PERIOD_MS, MIN_PERIOD_MS
from tilenca.protocol.line_reader import Heard
from tilenca.shapes.file import Shape, Task, load_task
from tilenca.shapes.sizes import Size, size_name
from tilenca.views.emulated import mismatch, take_picture, verdict
from tilenca.views.progress import Tell, show_progress
from tilenca.views.tiles import Picture, beside

ALL = "all"
WORKERS = 2
MAX_TILES = 255  # a tile's number is one byte
PLAIN_WIDTH = 80
DEFAULT_UPDATES = 30
NO_BOOTLOADER = "none"
# A UART that is off by a twentieth understands nothing; twice that is far enough to see it.
MAX_PPM = 100_000.0
MAX_BOOT_SPREAD_S = 3600.0
SETTLING_S = 0.001
MAX_SECONDS = 86_400.0
MAX_THREADS = 64

# Lays out one shape in tiles.
LayOut = Callable[[Shape], Emulation]


@dataclass(frozen=True)
class EmulationResult:
    """A shape that has run to its end; `notes` are for stderr, once each."""

    report: dict[str, Any]
    picture: Picture
    verdict: str
    notes: tuple[str, ...]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add = parser.add_argument
    add(
        "--shape",
        action="append",
        metavar="NAME",
        help="a shape, such as 4, or 4@2 if the label has two drawings; again for more (default: all)",
    )
    add(
        "--shapes",
        type=Path,
        default=paths.DEFAULT_SHAPES,
        metavar="F",
        help="shape file (shapes/digits.toml)",
    )
    add("--size", type=size, metavar="RxC", help="stretch the shapes to so many rows and columns, like 9x7")
    add("--elf", type=Path, default=paths.FIRMWARE_ELF, metavar="F", help="firmware image (the last build's)")
    length = parser.add_mutually_exclusive_group()
    length.add_argument(
        "--seconds", type=number(0.001, MAX_SECONDS), metavar="S", help="run for S emulated seconds"
    )
    length.add_argument(
        "--updates", type=count, metavar="N", help=f"run until every tile did N updates ({DEFAULT_UPDATES})"
    )
    add(
        "--period-ms",
        type=whole(MIN_PERIOD_MS, MAX_PERIOD_MS),
        metavar="N",
        help="update period of the tiles (the firmware's default)",
    )
    add(
        "--ppm",
        type=number(0.0, MAX_PPM),
        default=3000.0,
        metavar="X",
        help="clock errors within +-X ppm (3000)",
    )
    add(
        "--boot-spread",
        type=number(0.0, MAX_BOOT_SPREAD_S),
        default=1.0,
        metavar="S",
        help="switched on within 0..S seconds (1.0)",
    )
    add("--seed", type=seed, default=0, metavar="N", help="decides clock errors and switch-on times (0)")
    add(
        "--fault",
        action="append",
        type=parse_fault,
        default=[],
        metavar="SPEC",
        help="what goes wrong, where and when, such as loss=0.1 or cut@3-4:2-5; again for more (see "
        "docs/EMULATOR.md)",
    )
    add("--threads", type=whole(1, MAX_THREADS), default=1, metavar="N", help="threads for one shape (1)")
    add(
        "--eeprom",
        type=Path,
        metavar="DIR",
        help="one shape: load each tile's EEPROM from DIR, and keep it there at the end, of --serve too",
    )
    add("--vcd", type=Path, metavar="F", help="one shape: write the waveforms of its cables to F")
    add(
        "--pin",
        action="append",
        default=[],
        metavar="TILE:PIN",
        help="with --vcd: this pin, such as 3:H1, instead; again for more",
    )
    add(
        "--frames",
        type=Path,
        metavar="F",
        help="one shape: write the frames on its cables to F, as JSON lines",
    )
    add(
        "--gdb",
        action="append",
        default=[],
        metavar="TILE[:PORT]",
        help="one shape: wait for avr-gdb at this tile; again for more",
    )
    add("--record", type=Path, metavar="F", help="write all telemetry to F, one JSON object per line")
    look = parser.add_mutually_exclusive_group()
    look.add_argument("--json", action="store_true", help="one JSON document on stdout")
    look.add_argument("--watch", action="store_true", help="show the tiles while they run, in real time")
    look.add_argument(
        "--serve", type=Path, metavar="DIR", help="give each tile's USB serial as DIR/tile-01, ..."
    )
    add("--bootloader", metavar="F", help="with --serve: image of the boot section, or none (the stock one)")
    add("--keep-running", action="store_true", help="with --serve: opening a port does not reset its tile")


def run(args: argparse.Namespace) -> int:
    """Runs the command; 1 when a tile of any shape ends up wrong."""
    _check_combinations(args)
    task = load_task(args.shapes)
    shapes = _chosen(task, args.shape or [ALL], args.size)
    for option in ("serve", "eeprom", "vcd", "frames", "gdb"):
        if getattr(args, option) and len(shapes) != 1:
            raise UsageError(f"--{option} needs one shape, got {len(shapes)}; give --shape NAME")
    _check_readable(args.elf, "run `make demo` or `pio run`, or give --elf")
    defaults = firmware_settings(args.elf)
    settings = EmulationSettings(
        seconds=args.seconds,
        updates=args.updates or DEFAULT_UPDATES,
        period_ms=args.period_ms,
        ppm=args.ppm,
        boot_spread_s=args.boot_spread,
        seed=args.seed,
        bootloader=None if args.serve is None else _bootloader(args.bootloader),
        faults=tuple(args.fault),
        threads=args.threads,
        eeprom=args.eeprom,
    )

    def lay_out(shape: Shape) -> Emulation:
        return Emulation(task, shape, args.elf, settings, defaults)

    if args.serve is not None:
        emulation = lay_out(shapes[0])
        with emulation.array, _closely(emulation, args) as on_slice:
            serve(emulation, args.serve, args.seconds, not args.keep_running, on_slice)
        return 0
    with ExitStack() as stack:
        record = stack.enter_context(Recorder(args.record, "w")) if args.record else None
        if args.watch:
            outcomes = [_watch(args, lay_out, shape, record) for shape in shapes]
        else:
            with show_progress() as tell:
                outcomes = _run_all(args, lay_out, shapes, record, tell)
    _print(args, outcomes)
    for note in sorted({note for outcome in outcomes for note in outcome.notes}):
        warn(f"tilenca: {note}")
    return 0 if all(outcome.report["all_right"] for outcome in outcomes) else 1


def _check_combinations(args: argparse.Namespace) -> None:
    """Refuses what would be ignored; what excludes each other by itself, argparse knows."""
    serving = args.serve is not None
    if serving and not args.serve.name:
        raise UsageError("--serve needs a directory of its own for the tiles' links, such as tiles")
    for option, given in (("--record", args.record), ("--updates", args.updates)):
        if serving and given is not None:
            raise UsageError(f"{option} does nothing with --serve; use `tilenca monitor` on the served ports")
    if args.pin and args.vcd is None:
        raise UsageError("--pin does nothing without --vcd; add --vcd FILE or leave it out")
    for option, given in (("--bootloader", args.bootloader), ("--keep-running", args.keep_running or None)):
        if not serving and given is not None:
            raise UsageError(f"{option} does nothing without --serve; add --serve DIR or leave it out")


def _check_readable(image: Path, remedy: str) -> None:
    try:
        fact = None if stat.S_ISREG(image.stat().st_mode) else "not a file"
        if fact is None:
            image.open("rb").close()
    except OSError as error:
        fact = error.strerror
    if fact is not None:
        raise image_error(f"{image}: {fact}; {remedy}")


def _bootloader(given: str | None) -> Path | None:
    if given is None:
        return STOCK_BOOTLOADER if STOCK_BOOTLOADER.exists() else None
    if given == NO_BOOTLOADER:
        return None
    _check_readable(Path(given), f"give --bootloader an ELF or Intel HEX file, or {NO_BOOTLOADER}")
    return Path(given)


def _chosen(task: Task, names: Sequence[str], wanted: Size | None) -> list[Shape]:
    chosen = list(task.shapes) if ALL in names else [task.find(name) for name in dict.fromkeys(names)]
    if wanted is not None:
        chosen = [other for shape in chosen if (other := shape.stretched(wanted)) is not None]
        if not chosen:
            raise UsageError(
                f"--size {size_name(wanted)}: no shape can be drawn that small; try a larger one"
            )
    for shape in chosen:
        if len(shape.cells) > MAX_TILES:
            raise UsageError(
                f"{task.path}: shape '{shape.name}' has {len(shape.cells)} tiles; at most {MAX_TILES}"
            )
    return chosen


def _record_line(shape: Shape, heard: Heard) -> str:
    tile = int(heard.port.rpartition("-")[2])
    return json.dumps({**as_record(heard), "tile": tile, "shape": shape.name}) + "\n"


def _outcome(emulation: Emulation, started: float) -> EmulationResult:
    notes = [f"not emulated: {warning}" for tile in emulation.array for warning in tile.warnings]
    if remedy := mismatch(emulation):
        notes.append(remedy)
    report = emulation.report(time.monotonic() - started)
    return EmulationResult(report, take_picture(emulation), verdict(emulation), tuple(notes))


@contextmanager
def _closely(
    emulation: Emulation, args: argparse.Namespace, stopped: Callable[[], bool] = lambda: False
) -> Iterator[Callable[[], None]]:
    """What is looked at besides the tiles' faces; the function is to be called after every slice of time.

    Args:
        emulation: the tiles.
        args: the command line.
        stopped: whether the run has been interrupted, for who waits outside the main thread.
    """
    with (
        _kept_eeprom(emulation, args.eeprom),
        waveforms(emulation, args.vcd, args.pin) as waves,
        frames(emulation, args.frames) as log,
        debuggers(emulation, args.gdb, stopped) as ports,
    ):

        def on_slice() -> None:
            if waves is not None:
                waves.collect()
            if log is not None:
                log.collect()
            attend(ports, stopped)

        on_slice()
        yield on_slice


@contextmanager
def _kept_eeprom(emulation: Emulation, directory: Path | None) -> Iterator[None]:
    try:
        yield
    finally:
        if directory is not None:
            for tile in emulation.array:
                save_eeprom(tile, directory)


def _run_all(
    args: argparse.Namespace, lay_out: LayOut, shapes: Sequence[Shape], record: Recorder | None, tell: Tell
) -> list[EmulationResult]:
    """Runs shapes side by side, since they know nothing of each other; results come in their order."""
    stopped = threading.Event()

    def one(shape: Shape) -> tuple[EmulationResult, list[str]]:
        started = time.monotonic()
        kept: list[str] = []

        def keep(heard: list[Heard], on_slice: Callable[[], None], running: Emulation) -> None:
            tell(shape.name, running.share_done(), f"{running.array.time_s:.2f} s emulated")
            if stopped.is_set():
                raise KeyboardInterrupt
            on_slice()
            if record is not None:
                kept.extend(_record_line(shape, line) for line in heard)

        tell(shape.name, 0.0, "laying out")
        emulation = lay_out(shape)
        with emulation.array, _closely(emulation, args, stopped.is_set) as on_slice:
            emulation.run(lambda _, heard: keep(heard, on_slice, emulation))
            return _outcome(emulation, started), kept

    outcomes = []
    with ThreadPoolExecutor(min(WORKERS, os.cpu_count() or 1)) as pool:
        try:
            for shape, (outcome, kept) in zip(shapes, pool.map(one, shapes), strict=True):
                outcomes.append(outcome)
                emulated_s, wall_s = outcome.report["simulated_s"], outcome.report["wall_s"]
                speed = emulated_s / max(wall_s, 0.001)
                warn(f"{shape.name}: {emulated_s:.1f} s emulated, {speed:.1f} times real time")
                if record is not None:
                    record.write(kept)
        except BaseException:
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return outcomes


def _watch(
    args: argparse.Namespace, lay_out: LayOut, shape: Shape, record: Recorder | None
) -> EmulationResult:
    """Runs one shape in step with the wall clock, or slower, and shows it."""
    console = Console()
    started = time.monotonic()
    emulation = lay_out(shape)
    told = [0] * len(emulation.array)
    with emulation.array, _closely(emulation, args) as on_slice, ExitStack() as stack:
        live = stack.enter_context(Live(console=console, auto_refresh=False)) if console.is_terminal else None

        def show(running: Emulation, heard: list[Heard]) -> None:
            on_slice()
            if record is not None:
                record.write(_record_line(shape, line) for line in heard)
            if live is not None:
                picture = beside([take_picture(running)], console, console.width, console.height)
                live.update(picture, refresh=True)
                time.sleep(max(0.0, started + running.array.time_s - time.monotonic()))
            else:
                _tell_changes(running, told)

        emulation.run(show)
        return _outcome(emulation, started)


def _tell_changes(emulation: Emulation, told: list[int]) -> None:
    """One plain line for every change of a display, for what is not a terminal."""
    news = []
    for tile in emulation.array:
        changes = tile.display_changes[told[tile.index] :]
        told[tile.index] += len(changes)
        # A tile sets its segments one by one: of what it shows within a millisecond only the last counts.
        for following, change in enumerate(changes, start=1):
            if following == len(changes) or changes[following].time_s - change.time_s > SETTLING_S:
                news.append((change.time_s, tile.index, change.segments))
    for time_s, index, segments in sorted(news):
        shown = emulation.label(segments) or "nothing"
        print(f"{time_s:8.3f} s  {emulation.shape.name}: tile {index + 1} shows {shown}")


def _print(args: argparse.Namespace, outcomes: Sequence[EmulationResult]) -> None:
    all_right = all(outcome.report["all_right"] for outcome in outcomes)
    if args.json:
        reports = [outcome.report for outcome in outcomes]
        print(json.dumps(reports[0] if len(reports) == 1 else {"runs": reports, "all_right": all_right}))
        return
    console = Console(highlight=False)
    if not (args.watch and console.is_terminal):  # there the last picture still stands
        width = console.width if console.is_terminal else PLAIN_WIDTH
        console.print(beside([outcome.picture for outcome in outcomes], console, width), soft_wrap=True)
    for outcome in outcomes:
        console.print(outcome.verdict, soft_wrap=True, markup=False)
    right = sum(outcome.report["all_right"] for outcome in outcomes)
    emulated_s = sum(outcome.report["simulated_s"] for outcome in outcomes)
    tiles = sum(len(outcome.report["tiles"]) for outcome in outcomes)
    console.print(
        f"{right} of {len(outcomes)} shapes right; {tiles} tiles, {emulated_s:.1f} s emulated", soft_wrap=True
    )
