"""`tilenca export --plan`: what a network of given widths would cost a tile, before it is trained."""

import argparse
import json

from tilenca.base.errors import TilencaError, UsageError
from tilenca.commands.arguments import whole
from tilenca.model import cost
from tilenca.model.file import DEFAULT_CHANNELS, DEFAULT_HIDDEN, MAX_WIDTH, Dimensions
from tilenca.protocol.constants import MAX_CHANNELS
from tilenca.views.table import table

WIDTHS = ("state", "hidden", "classes")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of a plan, in a group of their own."""
    group = parser.add_argument_group("plan", "does a network still fit? Nothing is read or written")
    group.add_argument(
        "--plan", action="store_true", help="print what widths cost; exit 1 if they are too slow"
    )
    group.add_argument(
        "--state",
        type=whole(2, MAX_CHANNELS),
        metavar="C",
        help=f"channels of the state (default {DEFAULT_CHANNELS})",
    )
    group.add_argument(
        "--hidden",
        type=whole(1, MAX_WIDTH),
        metavar="H",
        help=f"width of both hidden layers (default {DEFAULT_HIDDEN})",
    )
    group.add_argument(
        "--classes",
        type=whole(1, MAX_CHANNELS - 1),
        metavar="K",
        help="labels to tell apart (default: as many as the state has room for)",
    )


def asked(args: argparse.Namespace) -> bool:
    """Whether a plan is asked for.

    Raises:
        UsageError: options that do not go together.
    """
    widths = [name for name in WIDTHS if getattr(args, name) is not None]
    if widths and not args.plan:
        raise UsageError(f"--{widths[0]}: a trained model has its widths; add --plan to ask about others")
    if args.plan and (args.check or args.force):
        raise UsageError("--plan writes nothing; leave out --check and --force")
    return bool(args.plan)


def run(args: argparse.Namespace) -> int:
    """Estimates and prints.

    Raises:
        TilencaError: it fits, but not the firmware's period.
    """
    standard = Dimensions()
    channels = standard.channels if args.state is None else args.state
    hidden = standard.hidden1 if args.hidden is None else args.hidden
    size = Dimensions(channels, hidden, hidden)
    found = cost.check(size, size.max_classes if args.classes is None else args.classes)
    if args.json:
        print(json.dumps(found.as_json()))
    else:
        print(_text(found))
    if not found.fits_period:
        raise TilencaError(f"an update every {found.period_ms} ms is too often; {longer_period(found)}")
    return 0


def longer_period(found: cost.Fit) -> str:
    """The remedy for a network that does not fit the firmware's period."""
    return (
        f"build with -D TILENCA_PERIOD_MS={found.shortest_period_ms} in platformio.ini, or train with a "
        "smaller --hidden or --state"
    )


def _text(found: cost.Fit) -> str:
    size = found.dimensions
    update_ms = found.update_cycles / cost.CLOCK_PER_MS
    rows = (
        ("flash", f"{found.flash_bytes:,} bytes", f"of {cost.MAX_FLASH_BYTES:,} for weights"),
        ("SRAM", f"{found.sram_bytes:,} bytes", f"of {cost.SRAM_BYTES:,}, with any network"),
        ("buffers", f"{found.buffer_bytes:,} bytes", f"of {cost.WIDEST_BUFFERS:,}, sized for the widest"),
        ("update", f"{update_ms:.1f} ms", f"{found.update_cycles:,.0f} cycles with four neighbours"),
        ("busy", f"{found.load:.0%}", f"of the firmware's period of {found.period_ms} ms"),
        ("period", f"{found.shortest_period_ms} ms", f"at least, so that {cost.HEAD_ROOM:.0%} stay free"),
    )
    head = (
        f"5 x {size.channels} -> {size.hidden1} -> {size.hidden2} -> {size.channels}, {found.classes} classes"
    )
    return f"{head}, {found.macs:,} multiplications\n{table(rows[0], rows[1:])}"
