"""The options of `tilenca emulate`."""

import argparse
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.shipped import model_folder
from tilenca.commands.arguments import add_shapes_argument, count, number, seed, size, whole
from tilenca.emulator.board_faults import ALL_KINDS
from tilenca.emulator.board_faults import parse as parse_fault
from tilenca.emulator.hardware import UNPOWERED
from tilenca.protocol.constants import MAX_PERIOD_MS, MIN_PERIOD_MS

DEFAULT_UPDATES = 30
# A UART that is off by a twentieth understands nothing; twice that is far enough to see it.
MAX_PPM = 100_000.0
MAX_BOOT_SPREAD_S = 3600.0
MAX_SECONDS = 86_400.0
MAX_THREADS = 64


def add_emulate_arguments(parser: argparse.ArgumentParser) -> None:
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
        "such a drawing may take, and all of that if the model was not made of it)",
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
        f"{', '.join(ALL_KINDS)}",
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
    add(
        "--check-states",
        action="store_true",
        help="compare every state of every tile with the fast simulator's, byte by byte, given the same "
        "messages in the same order",
    )
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


def check_combinations(args: argparse.Namespace) -> None:
    """Refuses what would be ignored; what excludes each other by itself, argparse knows."""
    serving = args.serve is not None
    if serving and not args.serve.name:
        raise UsageError("--serve needs a directory of its own for the tiles' links, such as tiles")
    for option, given in (("--record", args.record), ("--updates", args.updates)):
        if serving and given is not None:
            raise UsageError(f"{option} does nothing with --serve; use `tilenca monitor` on the served ports")
    for option in ("watch", "serve", "gdb"):
        if args.check_states and getattr(args, option):
            raise UsageError(f"--check-states does not go with --{option}; leave one of them out")
    if args.pin and args.vcd is None:
        raise UsageError("--pin does nothing without --vcd; add --vcd FILE or leave it out")
    if args.keep_running and not serving:
        raise UsageError("--keep-running does nothing without --serve; add --serve DIR or leave it out")
