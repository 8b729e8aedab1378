"""`tilenca flash`: one firmware image into many boards side by side; skips boards that run it already."""

import argparse
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import NoDeviceError
from tilenca.base.project import firmware_image
from tilenca.base.shipped import model_folder, model_names
from tilenca.base.stdio import warn
from tilenca.commands.arguments import add_fleet_arguments, count, positive
from tilenca.commands.own_firmware import image_to_write
from tilenca.fleet.avrdude import Avrdude, Progress, find_avrdude
from tilenca.fleet.boards import Board, Found, find_fleet, tile_numbers
from tilenca.fleet.build import build
from tilenca.fleet.flash_state import failed_boards, remember
from tilenca.fleet.identify import PATIENCE_S, SILENT, Answer, ask_all
from tilenca.fleet.image import Image, check_image
from tilenca.fleet.programmer import ProgramResult, program_all
from tilenca.fleet.tiles_file import Place
from tilenca.views.flash import Display, display
from tilenca.views.flash_results import GOOD, FlashRow, tell

# Three of avrdude's attempts to get an answer, which are 5 s apart.
TIMEOUT_S = 12.0
USER = "tilenca flash"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_fleet_arguments(parser)
    parser.add_argument("--jobs", type=count, metavar="N", help="boards at a time (default: all)")
    image = parser.add_mutually_exclusive_group()
    image.add_argument(
        "--model",
        type=model_folder,
        metavar="DIR",
        help="write the firmware of this model, built beside its files: its directory, or one of: "
        f"{' '.join(model_names())} (the project's own firmware)",
    )
    image.add_argument("--hex", type=Path, metavar="F", help="write this Intel HEX image; nothing is built")
    parser.add_argument("--no-build", action="store_true", help="write the image that is there")
    parser.add_argument("--force", action="store_true", help="write it to tiles that already run it, too")
    parser.add_argument("--only", metavar="TILES", help="only these tiles, such as 3,7,9-12")
    parser.add_argument(
        "--failed", action="store_true", help="only boards that failed or were missing when last flashed"
    )
    parser.add_argument(
        "--timeout",
        type=positive,
        default=TIMEOUT_S,
        metavar="S",
        help="give a board up after S seconds without progress (default: %(default)g)",
    )
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


@dataclass
class _Flashing:
    """One call: the image, the boards' rows, and whether Ctrl-C ended it."""

    args: argparse.Namespace
    tool: Avrdude
    image: Image
    rows: dict[str, FlashRow]
    display: Display
    interrupted: bool = False
    answers: dict[str, Answer] = field(default_factory=dict)

    def run(self) -> None:
        """Asks, writes, asks again; an interrupt ends it between any two of them."""
        try:
            waiting = self._ask() if not self.args.force else list(self.rows)
            self._write(waiting)
            self._confirm([name for name in waiting if self.rows[name].result == "flashed"])
        except KeyboardInterrupt:
            self.interrupted = True

    def _hear(self, names: Sequence[str], phase: str) -> dict[str, Answer]:
        for name in names:
            self.display.show(name, Progress(phase, 0.0))
        patience_s = min(self.args.timeout, PATIENCE_S)
        return ask_all(names, USER, lambda name, answer: self.rows[name].hear(answer), patience_s)

    def _ask(self) -> list[str]:
        """The rows whose tile does not run this image yet."""
        waiting = []
        for name, answer in self._hear(list(self.rows), "asking").items():
            if answer.firmware_id == self.image.firmware_id:
                self._end(name, "skipped")
            else:
                waiting.append(name)
        return waiting

    def _write(self, names: Sequence[str]) -> None:
        def report(name: str, news: Progress | ProgramResult) -> None:
            if isinstance(news, Progress):
                self.display.show(name, news)
            elif news.result == "flashed":
                self.display.show(name, Progress("confirming", 0.0))
            else:
                self.display.done(name, news.result, news.error)

        jobs = self.args.jobs or max(len(names), 1)
        for outcome in program_all(self.tool, self.image.path, names, jobs, self.args.timeout, report):
            row = self.rows[outcome.port]
            row.end(outcome.result, outcome.error)
            row.seconds, row.attempts = outcome.seconds, outcome.attempts
            row.firmware_id = None if row.result == "flashed" else row.firmware_id
            self.interrupted |= outcome.result == "interrupted"

    def _confirm(self, names: Sequence[str]) -> None:
        """Asks each tile for its firmware: avrdude has verified the written flash, but not that it runs."""
        if self.interrupted:
            return
        for name, answer in self._hear(names, "confirming").items():
            self._end(name, *self._judge(answer))

    def _judge(self, answer: Answer) -> tuple[str, str | None]:
        if answer.firmware_id == self.image.firmware_id:
            return "flashed", None
        if answer.hello:
            return "failed", (
                f"it was written and read back, but the tile says it runs firmware {answer.firmware_id:08X}; "
                "press its reset, then flash it again"
            )
        if self.args.hex:
            return "flashed", None  # any program may be written; not all of them can say what they are
        if answer.problem == SILENT:
            return "failed", f"it was written and read back, but the tile {SILENT}; press its reset"
        return "failed", f"it was written and read back, but cannot be asked what it runs: {answer.problem}"

    def _end(self, name: str, result: str, error: str | None = None) -> None:
        self.rows[name].end(result, error)
        self.display.done(name, result, error)


def run(args: argparse.Namespace) -> int:
    """Finds the boards, builds, checks the image, programs all of them; see `tilenca flash --help`."""
    wanted = None if args.only is None else tile_numbers(args.only)
    found = find_fleet(args.port, args.tiles)
    found.tell_others()
    boards, missing = _failed(found) if args.failed else (found.boards, found.missing)
    if wanted is not None:
        boards, missing = _only(wanted, boards), [place for place in missing if place.tile in wanted]
        if not (boards or missing or args.failed):
            raise NoDeviceError(
                f"no tile {args.only} is connected; `tilenca devices` lists what is, and "
                "`tilenca devices --learn` finds out which tile is which"
            )
    rows: dict[str, FlashRow] = {}
    interrupted = False
    if boards:
        tool, image = find_avrdude(), _image(args)
        rows = {
            board.port.name: FlashRow(board.port.name, tile=board.tile, board=board.name) for board in boards
        }
        interrupted = _program(args, tool, image, rows)
    absent = [
        FlashRow(None, "missing", 0.0, "not connected; connect it and flash again", place.tile, place.board)
        for place in missing
    ]
    everything = [*rows.values(), *absent]
    if not everything:
        warn("nothing to do: no board of those failed or was missing when last flashed")
    remember({row.board: row.result in GOOD for row in everything})
    tell(everything, args.json)
    if interrupted:
        raise KeyboardInterrupt
    if all(row.result in GOOD for row in everything):
        return 0
    ports = ", with the same --port" if args.port else ""
    model = f" --model {shlex.quote(str(args.model))}" if args.model else ""
    warn(f"to try again those that failed or were missing: tilenca flash --failed{model}{ports}")
    return 1


def _failed(found: Found) -> tuple[list[Board], list[Place]]:
    """The part of the fleet that `--failed` selects."""
    names = failed_boards()
    boards = [board for board in found.boards if board.name in names]
    return boards, [place for place in found.missing if place.board in names]


def _only(wanted: set[int], boards: list[Board]) -> list[Board]:
    """The boards that `--only` selects; asks the boards whose ids no file lists."""
    ids = {board.port.name: board.tile for board in boards}
    unknown = [name for name, tile in ids.items() if tile is None]
    for name, answer in ask_all(unknown, USER).items():
        ids[name] = answer.hello.tile if answer.hello else None
    return [board for board in boards if ids[board.port.name] in wanted]


def _image(args: argparse.Namespace) -> Image:
    """The image to write: built if necessary, and checked before a board is touched."""
    if args.hex:
        return check_image(args.hex)
    if args.model:
        return check_image(image_to_write(args.model, not args.no_build).with_suffix(".hex"))
    if paths.PROJECT is not None and not args.no_build:
        build()
    return check_image(firmware_image().with_suffix(".hex"))


def _program(args: argparse.Namespace, tool: Avrdude, image: Image, rows: dict[str, FlashRow]) -> bool:
    """Programs the boards and fills their rows in; whether it was interrupted."""
    number = f"{len(rows)} board{'s' * (len(rows) != 1)}"
    warn(f"image {image.path}: {image.size} bytes, firmware id {image.firmware_id:08X}")
    whom = number if args.force else f"those of {number} that do not run it yet"
    warn(f"writing it to {whom}, with {tool.program}")
    titles = {name: name + (f" tile {row.tile}" if row.tile else "") for name, row in rows.items()}
    with display(titles) as shown:
        flashing = _Flashing(args, tool, image, rows, shown)
        flashing.run()
    return flashing.interrupted
