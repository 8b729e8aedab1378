"""The command line's grammar that all commands share: the parser, and the types of its values."""

import argparse
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

from tilenca.base import paths
from tilenca.base.errors import UsageError, image_error
from tilenca.base.shipped import model_folder, model_names, shapes_file, shapes_names
from tilenca.base.stdio import warn
from tilenca.base.suggest import did_you_mean
from tilenca.fleet.tiles_file import DEFAULT
from tilenca.shapes.sizes import Size, parse_size

MAX_COUNT = 1_000_000
SCHEDULES = ("clock", "random", "listing")  # simulator/conditions.py has them, with numpy


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, as all of ours."""

    def error(self, message: str) -> NoReturn:
        """Says what is wrong and where help is; exits with 2."""
        warn(f"{self.prog}: {' '.join(message.split())}; see {self.prog} --help")
        raise SystemExit(UsageError.exit_status)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> tuple[Any, list[str]]:
        """Refuses what it does not know itself, so that the complaint names the subcommand."""
        known, unknown = super().parse_known_args(args, namespace)
        if unknown:
            option = unknown[0].partition("=")[0]
            meant = ""
            if option.startswith("--"):
                names = [name[2:] for name in self._option_string_actions if name.startswith("--")]
                meant = did_you_mean(option[2:], names).replace("'", "'--", 1)
            self.error(f"unrecognized arguments: {' '.join(unknown)}{meant}")
        return known, unknown


def number(lowest: float, highest: float = float("inf")) -> Callable[[str], float]:
    """The type of a real number in `lowest`..`highest`; not a number and infinity are refused."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not lowest <= value <= highest or value == float("inf"):
            raise argparse.ArgumentTypeError(f"'{text}' is not a number {_range(lowest, highest)}")
        return value

    return parse


def whole(lowest: int, highest: int = MAX_COUNT) -> Callable[[str], int]:
    """The type of a whole number in `lowest`..`highest`."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = lowest - 1
        if not lowest <= value <= highest:
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number {_range(lowest, highest)}")
        return value

    return parse


def size(text: str) -> Size:
    """The type of rows and columns, like 5x4."""
    try:
        return parse_size(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _range(lowest: float, highest: float) -> str:
    return f"from {_shown(lowest)}" + ("" if highest == float("inf") else f" to {_shown(highest)}")


def _shown(limit: float) -> str:
    return str(limit) if isinstance(limit, int) else f"{limit:.10g}"


# A thousandth of a second is the least that means anything to a tile.
positive = number(0.001)
not_negative = number(0.0)
count = whole(1)
share = number(0.0, 1.0)
seed = whole(0, 2**63 - 1)


def add_model_argument(parser: argparse.ArgumentParser) -> None:
    """The `--model` option of all commands that read a trained model."""
    parser.add_argument(
        "--model",
        type=model_folder,
        default=paths.DEFAULT_MODEL,
        metavar="DIR",
        help=f"the model's directory, or one of: {' '.join(model_names())} (digits)",
    )


OWN_SHAPES = "those that the model was trained on"


def add_shapes_argument(add: Callable[..., Any], what: str, usual: str = "digits", **more: Any) -> None:
    """The `--shapes` option of all commands that read shape files.

    Args:
        add: `add_argument` of a parser or a group.
        what: the rest of the help text, before the names of the files that come with tilenca.
        usual: the files where none are given, for the help text.
        more: further arguments of `add`.
    """
    names = " ".join(shapes_names())
    add("--shapes", type=shapes_file, metavar="F", help=f"{what}, or one of: {names} ({usual})", **more)


def add_condition_arguments(parser: argparse.ArgumentParser) -> None:
    """`--schedule`, `--loss`, `--lost` and `--dead`: the conditions of simulated runs."""
    add = parser.add_argument
    add(
        "--schedule",
        choices=SCHEDULES,
        default="clock",
        help="clock: the tiles' own clocks; listing: the paper's, one tile after another; random: two random "
        "halves a step (clock)",
    )
    add("--loss", type=share, default=0.0, metavar="P", help="share of messages lost, 0..1 (0)")
    add(
        "--lost",
        choices=("held", "zero"),
        default="held",
        help="a lost message reads as the last one, or as zero (held)",
    )
    add("--dead", type=share, default=0.0, metavar="P", help="share of tiles that are dead, 0..1 (0)")


def add_cluster_arguments(parser: argparse.ArgumentParser) -> None:
    """`--jobs` or `--scheduler`: where work for many cores runs."""
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--jobs", type=whole(1, 1024), metavar="N", help="processes on this machine (one for each processor)"
    )
    add_scheduler_argument(where.add_argument)


def add_scheduler_argument(add: Callable[..., Any]) -> None:
    """The `--scheduler` option of all commands that use a cluster."""
    add(
        "--scheduler",
        metavar="ADDRESS",
        help="a Dask scheduler instead: its address, such as tcp://10.0.0.5:8786, or the file that it writes",
    )


def add_port_argument(parser: argparse.ArgumentParser, otherwise: str = "default: Mega 2560s on USB") -> None:
    """The `--port` option that all fleet commands share; `otherwise` says in the help what goes without."""
    parser.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="GLOB",
        help=f"a port or a quoted pattern, such as '/dev/ttyACM*', repeatable ({otherwise})",
    )


def add_fleet_arguments(
    parser: argparse.ArgumentParser, otherwise: str = "default: Mega 2560s on USB"
) -> None:
    """`--port` and `--tiles`, which all fleet commands share."""
    add_port_argument(parser, otherwise)
    parser.add_argument(
        "--tiles",
        type=Path,
        metavar="F",
        help=f"each tile's board and place (default: {DEFAULT}, if there is one)",
    )


def existing_image(image: Path, remedy: str) -> None:
    """Checks that a firmware image is a file that can be read.

    Raises:
        BuildError, UsageError: it is not; see `image_error`.
    """
    try:
        fact = None if stat.S_ISREG(image.stat().st_mode) else "not a file"
        if fact is None:
            image.open("rb").close()
    except OSError as error:
        fact = error.strerror
    if fact is not None:
        raise image_error(f"{image}: {fact}; {remedy}")
