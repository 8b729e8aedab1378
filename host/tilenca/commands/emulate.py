"""`tilenca emulate`: the firmware image on one emulated board per tile, wired as on the real board."""

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.project import build_remedy, firmware_image
from tilenca.base.shipped import model_folder
from tilenca.base.stdio import warn
from tilenca.commands.arguments import (
    add_shapes_argument,
    count,
    existing_image,
    number,
    seed,
    size,
    whole,
)
from tilenca.commands.emulate_runs import observe, print_results, run_all, updates_for, watch
from tilenca.commands.origin import model_with_id, own_shapes, without_a_dash
from tilenca.commands.own_firmware import image_of
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.faults import KINDS
from tilenca.emulator.faults import parse as parse_fault
from tilenca.emulator.greeting import greeting, settings_of
from tilenca.emulator.hardware import UNPOWERED
from tilenca.emulator.lag import Lag
from tilenca.emulator.serve import STOCK_BOOTLOADER, serve
from tilenca.emulator.side_by_side import threads_of_each
from tilenca.fleet.recording import Recorder
from tilenca.model.file import Model
from tilenca.protocol.constants import MAX_PERIOD_MS, MIN_PERIOD_MS
from tilenca.protocol.sentences import HelloSentence
from tilenca.shapes.file import UNKNOWN, Shape, Task, load_task, too_large
from tilenca.shapes.sizes import Size, size_name
from tilenca.views.emulated import foreign_firmware
from tilenca.views.lag import show_lag

ALL = "all"
DEFAULT_UPDATES = 30
NO_BOOTLOADER = "none"
# A UART that is off by a twentieth understands nothing; twice that is far enough to see it.
MAX_PPM = 100_000.0
MAX_BOOT_SPREAD_S = 3600.0
MAX_SECONDS = 86_400.0
MAX_THREADS = 64


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add = parser.add_argument
    add(
        "--shape",
        action="append",
        metavar="NAME",
        help="a shape, such as 4, or 4@2 if the label has two drawings; again for more (default: all)",
    )
    add_shapes_argument(add, "shape file", "that of the firmware's model")
    add("--size", type=size, metavar="RxC", help="stretch the shapes to so many rows and columns, like 9x7")
    image = parser.add_mutually_exclusive_group()
    image.add_argument(
        "--model", type=model_folder, metavar="DIR", help="the firmware that was built of this model"
    )
    image.add_argument(
        "--elf", type=Path, metavar="F", help="firmware image (the last build's, or the one of the package)"
    )
    length = parser.add_mutually_exclusive_group()
    length.add_argument(
        "--seconds", type=number(0.001, MAX_SECONDS), metavar="S", help="run for S emulated seconds"
    )
    length.add_argument(
        "--updates",
        type=count,
        metavar="N",
        help=f"run until every tile did N updates ({DEFAULT_UPDATES}, or more until all agree, at most what "
        "such a drawing may take)",
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
        help="a fault with its place and time, such as loss=0.1 or cut@3-4:2-5; again for more. Kinds: "
        f"{', '.join(KINDS)}",
    )
    add(
        "--threads",
        type=whole(1, MAX_THREADS),
        metavar="N",
        help="threads for each shape (all processors have work)",
    )
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
    add(
        "--bootloader",
        metavar="F",
        help="image of the boot section, where tiles start as on every board, or none (the stock one)",
    )
    add(
        "--unpowered",
        choices=UNPOWERED,
        default=UNPOWERED[0],
        help="what a tile without power does to its neighbours' inputs (low)",
    )
    add("-v", "--verbose", action="store_true", help="list every tile that shows something else")
    add("--keep-running", action="store_true", help="with --serve: opening a port does not reset its tile")


def run(args: argparse.Namespace) -> int:
    """Runs the command; 1 when a tile of any shape ends up wrong."""
    _check_combinations(args)
    image = args.elf or (image_of(args.model) if args.model else firmware_image())
    existing_image(image, f"{build_remedy()}, or give --elf")
    hello = greeting(image)
    defaults = settings_of(hello)
    known = None if hello is None else model_with_id(hello.model_id, args.model)
    if args.shapes is None:
        args.shapes = own_shapes(*known)[0] if known else paths.DEFAULT_SHAPES
    task = load_task(args.shapes)
    shapes = _chosen(task, args.shape or [ALL], args.size)
    for option in ("serve", "eeprom", "vcd", "frames", "gdb"):
        if getattr(args, option) and len(shapes) != 1:
            raise UsageError(f"--{option} needs one shape, got {len(shapes)}; give --shape NAME")
    told = _foreign(hello, known and known[0], task)
    args.foreign = bool(told)
    for note in told:
        warn(f"tilenca: {note}")
    settings = EmulationSettings(
        seconds=args.seconds,
        updates=args.updates or DEFAULT_UPDATES,
        period_ms=args.period_ms,
        ppm=args.ppm,
        boot_spread_s=args.boot_spread,
        seed=args.seed,
        bootloader=_bootloader(args.bootloader),
        unpowered=args.unpowered,
        faults=tuple(args.fault),
        threads=args.threads or threads_of_each(len(shapes)),
        eeprom=args.eeprom,
    )

    def lay_out(shape: Shape) -> Emulation:
        most = None if args.updates else updates_for(shape)
        return Emulation(shape, task.labels, image, replace(settings, most_updates=most), defaults)

    if args.serve is not None:
        _serve(args, lay_out(shapes[0]))
        return 0
    with ExitStack() as stack:
        record = stack.enter_context(Recorder(args.record, "w")) if args.record else None
        if args.watch:
            results = [watch(args, task, lay_out, shape, record) for shape in shapes]
        else:
            results = run_all(args, task, lay_out, shapes, record)
    print_results(args, results)
    for note in sorted({note for result in results for note in result.notes} - set(told)):
        warn(f"tilenca: {note}")
    return 0 if all(result.report["all_right"] for result in results) else 1


def _foreign(hello: HelloSentence | None, model: Model | None, task: Task) -> list[str]:
    """What to say before the run where the firmware's model does not know a class of the file."""
    if hello is None:
        return []
    if model is None:
        fits = hello.classes in (len(task.labels), len({*task.labels, UNKNOWN}))
    else:
        fits = set(task.labels) <= set(model.labels)
    notes = [] if fits else [foreign_firmware(hello, task)]
    return notes + [note for note in (model and without_a_dash(model),) if notes and note]


def _serve(args: argparse.Namespace, emulation: Emulation) -> None:
    """Gives the tiles' serial ports to other programs, and tells how far they fall behind."""
    lag = Lag()
    with emulation.array, observe(emulation, args) as look, show_lag(lag) as tell:

        def on_slice() -> None:
            look()
            tell()

        serve(emulation, args.serve, args.seconds, not args.keep_running, on_slice, lag)


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
    if args.keep_running and not serving:
        raise UsageError("--keep-running does nothing without --serve; add --serve DIR or leave it out")


def _bootloader(given: str | None) -> Path | None:
    if given is None:
        if not STOCK_BOOTLOADER.exists():
            warn(
                f"tilenca: no {STOCK_BOOTLOADER}, so tiles have no bootloader; install Arduino's AVR core "
                f"(Debian: arduino-core-avr), or say so with --bootloader {NO_BOOTLOADER}"
            )
            return None
        return STOCK_BOOTLOADER
    if given == NO_BOOTLOADER:
        return None
    existing_image(Path(given), f"give --bootloader an ELF or Intel HEX file, or {NO_BOOTLOADER}")
    return Path(given)


def _chosen(task: Task, names: Sequence[str], wanted: Size | None) -> list[Shape]:
    chosen = list(task.shapes) if ALL in names else [task.find(name) for name in dict.fromkeys(names)]
    if wanted is not None:
        chosen = [other for shape in chosen if (other := shape.stretched(wanted)) is not None]
        if not chosen:
            raise UsageError(
                f"--size {size_name(wanted)}: no shape can be drawn that small; try a larger one"
            )
    if (remedy := too_large(chosen)) is not None:
        raise UsageError(f"{task.path}: {remedy}")
    return chosen
