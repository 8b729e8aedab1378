"""`tilenca devices`: the ports behind which tiles are, and which tile each is according to `tiles.toml`.

Nothing is opened: opening its port resets a Mega.
"""

import argparse
import json
from typing import Any

from tilenca.boards import Board, Found, add_fleet_arguments, find_boards
from tilenca.ports import natural_key
from tilenca.streams import warn
from tilenca.tables import table
from tilenca.tilesfile import Place

HEADER = ("PORT", "TILE", "PLACE", "USB ID", "BOARD", "WHAT")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_fleet_arguments(parser)
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


def run(args: argparse.Namespace) -> int:
    """Prints the devices; see `tilenca devices --help`."""
    found = find_boards(args.port, args.tiles)
    everything = sorted(found.boards + found.others, key=lambda board: natural_key(board.port.name))
    present = [board for board in everything if board.port.present]
    for board in everything:
        if not board.port.present:
            warn(f"{board.port.name}: {board.port.about}")
    for place in found.missing:
        warn(f"tile {place.tile} ({place.board}): not connected")
    if args.json:
        print(json.dumps(document(present, found), indent=2))
    else:
        print(table(HEADER, [_row(board) for board in present]))
    return 0


def document(present: list[Board], found: Found) -> dict[str, Any]:
    """The whole document; boards in the order of their ports, then the tiles that are not connected."""
    missing = [{"tile": p.tile, "row": p.row, "col": p.col, "board": p.board} for p in found.missing]
    return {"devices": [as_json(board) for board in present], "missing": missing}


def as_json(board: Board) -> dict[str, Any]:
    """One entry of the document: USB ids are four lower-case hex digits, as lsusb writes them, or null."""
    port, place = board.port, board.place
    return {
        "port": port.name,
        "vid": None if port.vid is None else f"{port.vid:04x}",
        "pid": None if port.pid is None else f"{port.pid:04x}",
        "serial_number": port.serial_number,
        "location": port.location,
        "board": board.name,
        "tile": board.tile,
        "row": place.row if place else None,
        "col": place.col if place else None,
        "about": port.about,
    }


def _row(board: Board) -> list[str]:
    port = board.port
    ids = "-" if port.vid is None or port.pid is None else f"{port.vid:04x}:{port.pid:04x}"
    return [port.name, _text(board.tile), _where(board.place), ids, board.name, port.about or "-"]


def _text(value: object) -> str:
    return "-" if value is None else str(value)


def _where(place: Place | None) -> str:
    return f"{place.row},{place.col}" if place else "-"
