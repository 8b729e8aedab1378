"""`tilenca devices`: the ports behind which tiles are, and which tile each is according to `tiles.toml`.

Without --ask and --learn nothing is opened: opening its port may reset a Mega.
"""

import argparse
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.sides import SIDES
from tilenca.base.stdio import warn
from tilenca.commands.arguments import add_fleet_arguments
from tilenca.fleet.boards import (
    Board,
    Found,
    find_boards,
    match_ports,
    names_now,
    none_connected,
    ports_on_usb,
    tell_contradiction,
    tell_models,
)
from tilenca.fleet.discover import Learnt, learn
from tilenca.fleet.identify import BOARD_S, Answer, ask_all
from tilenca.fleet.link_health import WELL
from tilenca.fleet.ports import natural_key
from tilenca.fleet.side_hints import SUPPLY_REMEDY, line_hints
from tilenca.fleet.tiles_file import DEFAULT, Place, read_tiles, tile_count, write_tiles
from tilenca.fleet.tiles_update import update
from tilenca.protocol.constants import LEAST_SUPPLY_MV
from tilenca.protocol.sentences import ChipSentence
from tilenca.views.table import table

MEGA_FUSES = 0xFF, 0xD8  # low: the resonator; high: the boot section of 8 KiB starts first
MEGA_EXTENDED_FUSES = 0xFD, 0xFC  # brown-out at 2.7 V, or at 4.3 V
HEADER = ("PORT", "TILE", "PLACE", "USB ID", "BOARD", "FIRMWARE", "WHAT")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_fleet_arguments(parser)
    parser.add_argument("--ask", action="store_true", help="ask each tile for its id and firmware")
    parser.add_argument(
        "--learn",
        action="store_true",
        help="find each tile's place, and write the file of tiles",
    )
    parser.add_argument(
        "--blink", action="store_true", help="with --learn: enter the place of each blinking tile"
    )
    parser.add_argument(
        "--assign", action="store_true", help="with --learn: give tiles without an id a free one"
    )
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


def run(args: argparse.Namespace) -> int:
    """Prints the devices; see `tilenca devices --help`."""
    for option in ("blink", "assign"):
        if getattr(args, option) and not args.learn:
            raise UsageError(f"--{option} does nothing without --learn; add it, or leave --{option} out")
    found = Found(match_ports(args.port)) if args.learn else find_boards(args.port, args.tiles)
    everything = sorted(found.boards + found.others, key=lambda board: natural_key(board.port.name))
    present = [board for board in everything if board.port.present]
    for board in everything:
        if not board.port.present:
            warn(f"{board.port.name}: {board.port.about}")
    for place in found.missing:
        warn(f"tile {place.tile} ({place.board}): not connected")
    answers: dict[str, Answer] = {}
    left_out = 0
    if args.learn:
        learnt, places = _learn(args, present)
        answers, left_out = learnt.answers, learnt.left_out
        present = [replace(board, place=places.get(board.name)) for board in present]
        found = Found([], find_boards([], args.tiles).missing)
    elif args.ask:
        answers = ask_all([board.port.name for board in present], "tilenca devices", board_s=BOARD_S)
        for board in present:
            tell_contradiction(board.port.name, board.tile, answers[board.port.name].hello)
        tell_models({name: answer.hello for name, answer in answers.items() if answer.hello})
        left_out = sum(answer.hello is None for answer in answers.values())
    if args.json:
        print(json.dumps(document(present, found, answers), indent=2))
    else:
        print(table(HEADER, [_row(board, answers.get(board.port.name)) for board in present]))
    if not present:
        raise none_connected(found, args.tiles)
    if not (args.json or args.ask or args.learn):
        warn(
            "next: tilenca devices --ask asks each tile for its id and firmware; opening a port may reset it"
        )
    return 1 if left_out else 0


def _learn(args: argparse.Namespace, present: list[Board]) -> tuple[Learnt, dict[str, Place]]:
    """Learns where the boards are, and writes that; also returns the places by the boards' names.

    Raises:
        TilencaError: nothing could be learnt, or it does not go with what the file says of other boards.
    """
    file = args.tiles or DEFAULT
    old, complaint = _before(file)
    if complaint and os.path.lexists(_aside(file)):
        raise UsageError(
            f"{complaint.partition('; ')[0]}; correct it, or remove {_aside(file)}: it would be that"
        )
    before = names_now(old, present, ports_on_usb())
    learnt = learn(present, args.blink, args.assign, before)
    if not learnt.places:
        state = "is left as it was" if file.exists() else "is not written"
        raise TilencaError(f"no tile was given a place: {file} {state}; learn again")
    heard = {place.board for place in learnt.places}
    kept = [place for place in before if place.board not in heard]
    new = update(before, learnt.places, kept, fixed=args.blink)
    if complaint:
        _put_aside(file, complaint)
    write_tiles(file, new.places)
    for remark in new.remarks:
        warn(f"{file}: {remark}")
    warn(f"{file}: {tile_count(len(new.places))}")
    return learnt, {place.board: place for place in new.places}


def _before(file: Path) -> tuple[list[Place], str]:
    """The file's entries so far, and the reason if it cannot be read."""
    if not file.exists():
        return [], ""
    try:
        return read_tiles(file), ""
    except UsageError as error:
        if not file.is_file():
            raise
        return [], str(error)


def _aside(file: Path) -> Path:
    return file.with_name(file.name + ".old")


def _put_aside(file: Path, complaint: str) -> None:
    """Keeps a copy of a file that cannot be read, so that a person's entries are not lost."""
    aside = _aside(file)
    try:
        file.replace(aside)
    except OSError as error:
        raise UsageError(f"{file}: {error.strerror}; name another with --tiles") from error
    warn(f"{complaint.partition('; ')[0]}; it is {aside} now")


def document(present: list[Board], found: Found, answers: dict[str, Answer]) -> dict[str, Any]:
    """The whole document; boards in the order of their ports, then the tiles that are not connected."""
    missing = [{"tile": p.tile, "row": p.row, "col": p.col, "board": p.board} for p in found.missing]
    devices = [as_json(board, answers.get(board.port.name)) for board in present]
    return {"devices": devices, "missing": missing}


def as_json(board: Board, answer: Answer | None = None) -> dict[str, Any]:
    """One entry of the document: USB ids are four lower-case hex digits, as lsusb writes them, or null."""
    port, place = board.port, board.place
    hello = answer.hello if answer else None
    return {
        "port": port.name,
        "vid": None if port.vid is None else f"{port.vid:04x}",
        "pid": None if port.pid is None else f"{port.pid:04x}",
        "serial_number": port.serial_number,
        "location": port.location,
        "board": board.name,
        "tile": board.tile or (hello.tile if hello else None) or None,
        "row": place.row if place else None,
        "col": place.col if place else None,
        "about": port.about,
        "firmware_id": f"{hello.firmware_id:08X}" if hello else None,
        "model_id": f"{hello.model_id:04X}" if hello else None,
        "fuses": _fuses(answer.chip) if answer and answer.chip else None,
        "marking": answer.chip.marking if answer and answer.chip else None,
        "supply_mv": answer.board.supply_mv if answer and answer.board else None,
        "error": answer.problem or None if answer else None,
    }


def _row(board: Board, answer: Answer | None) -> list[str]:
    port, hello = board.port, answer.hello if answer else None
    ids = "-" if port.vid is None or port.pid is None else f"{port.vid:04x}:{port.pid:04x}"
    tile = board.tile or (hello.tile if hello else None) or None
    firmware = f"{hello.firmware_id:08X}" if hello else "-"
    facts = (
        [port.about, answer.problem, *_chip_facts(answer.chip), *_board_facts(answer)]
        if answer
        else [port.about]
    )
    about = "; ".join(filter(None, facts)) or "-"
    return [port.name, _text(tile), _where(board.place), ids, board.name, firmware, about]


def _board_facts(answer: Answer) -> list[str]:
    """The supply, and lines and links at which something is wrong now, each with what to do."""
    if (board := answer.board) is None:
        return []
    low = f": {SUPPLY_REMEDY}" if board.supply_mv and board.supply_mv < LEAST_SUPPLY_MV else ""
    supply = [] if board.supply_mv is None else [f"{board.supply_mv / 1000:.1f} V{low}"]
    hints = {side: hint.text for side, hint in line_hints(board, answer.board_before).items()}
    for side, health in answer.health.items():
        if side not in hints and health.good is not None and health.good < WELL:
            hints[side] = (
                f"{health.good:.0%} of the frames arrive: the plug, or a resonator (docs/BOARD_TEST.md)"
            )
    return [*supply, *(f"side {side}: {hints[side]}" for side in SIDES if side in hints)]


def _fuses(chip: ChipSentence) -> str:
    return f"{chip.low:02X} {chip.high:02X} {chip.extended:02X} {chip.lock:02X}"


def _chip_facts(chip: ChipSentence | None) -> list[str]:
    """The board's marking, and the fuses, if they are not a Mega's."""
    if chip is None:
        return []
    marking = [] if chip.revision is None else [f"board revision {chip.revision}, serial {chip.serial}"]
    if (chip.low, chip.high) == MEGA_FUSES and chip.extended in MEGA_EXTENDED_FUSES:
        return marking
    return [*marking, f"fuses {_fuses(chip)[:-3]}, and a Mega has FF D8 FD: set them with a programmer"]


def _text(value: object) -> str:
    return "-" if value is None else str(value)


def _where(place: Place | None) -> str:
    return f"{place.row},{place.col}" if place else "-"
