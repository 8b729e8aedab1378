"""`tiles.toml`: the id, the place and the board of each tile.

    [[tile]]
    id = 7
    row = 0
    col = 3
    board = "serial:95530343634351A0B1C2"

A board's name survives replugging: `serial:` is its adapter's serial number; where
adapters have none or share one, `location:` the USB socket; `port:` the name of a device that is not on USB.
Rows count from the north, columns from the west.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_toml
from tilenca.base.whole_file import write_whole

DEFAULT = Path("tiles.toml")
MAX_TILE_ID = 255
KINDS = ("serial", "location", "port")
KEYS = {"id", "row", "col", "board"}
# More rows or columns than any table has room for are a typing error.
FAR = 999

HEAD = """\
# Which board is which tile, and where it lies: rows from the north, columns from the west.
# Written by `tilenca devices --learn`; edit it as you like.
"""

_HEADER = re.compile(r"\s*\[\[\s*tile\s*\]\]\s*(#.*)?$")
_UNSAFE = re.compile(r'[\x00-\x1f\x7f"\\]')


@dataclass(frozen=True)
class Place:
    """One tile of the file: its id, its board, and where it lies."""

    tile: int
    board: str
    row: int
    col: int


def read_tiles(path: Path) -> list[Place]:
    """The tiles of a file, in its order.

    Raises:
        UsageError: it cannot be read or is not valid; the message names the line.
    """
    try:
        text = path.read_text(encoding="utf-8")
        document = read_toml(text)
    except OSError as error:
        raise UsageError(
            f"{path}: {error.strerror}; write it with `tilenca devices --learn`, or name another with --tiles"
        ) from error
    except ValueError as error:  # not UTF-8, or not TOML
        raise UsageError(f"{path}: {error}; correct it, or write it anew with --learn") from error
    tables = document.get("tile", [])
    if set(document) - {"tile"} or not isinstance(tables, list):
        raise UsageError(f"{path}: only [[tile]] tables belong here")
    lines = [number for number, line in enumerate(text.splitlines(), start=1) if _HEADER.match(line)]
    wheres = [f"{path}:{line}" for line in lines] if len(lines) == len(tables) else [str(path)] * len(tables)
    places: list[Place] = []
    for where, about in zip(wheres, tables, strict=True):
        try:
            places.append(_place(about, places))
        except ValueError as error:
            raise UsageError(f"{where}: {error}") from error
    return places


def _place(about: Any, others: list[Place]) -> Place:
    if not isinstance(about, dict) or set(about) != KEYS:
        raise ValueError("a [[tile]] has id, row, col and board, and nothing else")
    numbers = [about["id"], about["row"], about["col"]]
    if any(type(number) is not int for number in numbers):
        raise ValueError("id, row and col are whole numbers")
    if any(abs(number) > FAR for number in numbers[1:]):
        raise ValueError(f"row and col are from -{FAR} to {FAR}")
    place = Place(numbers[0], about["board"], numbers[1], numbers[2])
    if not 1 <= place.tile <= MAX_TILE_ID:
        raise ValueError(f"id {place.tile} is not from 1 to {MAX_TILE_ID}")
    if not isinstance(place.board, str) or not re.fullmatch(f"({'|'.join(KINDS)}):[^\\0]+", place.board):
        raise ValueError('board is "serial:...", "location:..." or "port:..."')
    for other in others:
        if place.tile == other.tile:
            raise ValueError(f"two tiles have the id {place.tile}")
        if place.board == other.board:
            raise ValueError(f"tiles {other.tile} and {place.tile} are the same board")
        if (place.row, place.col) == (other.row, other.col):
            raise ValueError(f"tiles {other.tile} and {place.tile} lie at the same place")
    return place


def tile_count(count: int) -> str:
    """A number of tiles, in words."""
    return f"{count} tile{'s' * (count != 1)}"


def tile_list(tiles: Iterable[int]) -> str:
    """Ids as a list like `tiles 3, 7, 9-12`."""
    ids = sorted(tiles)
    runs: list[list[int]] = []
    for tile in ids:
        if runs and tile == runs[-1][-1] + 1:
            runs[-1].append(tile)
        else:
            runs.append([tile])
    parts = [f"{run[0]}-{run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return f"tile{'s' * (len(ids) != 1)} {', '.join(parts)}"


def format_tiles(places: Iterable[Place]) -> str:
    """The file's text; tiles in reading order."""
    tables = [
        f"\n[[tile]]\nid = {p.tile}\nrow = {p.row}\ncol = {p.col}\nboard = {_quoted(p.board)}\n"
        for p in sorted(places, key=lambda place: (place.row, place.col))
    ]
    return HEAD + "".join(tables)


def _quoted(text: str) -> str:
    """A TOML basic string."""
    return '"' + _UNSAFE.sub(lambda match: f"\\u{ord(match[0]):04X}", text) + '"'


def write_tiles(path: Path, places: Iterable[Place]) -> None:
    """Writes the file; the old one stays whole until the new one is complete.

    Raises:
        UsageError: it cannot be written.
    """
    write_whole(path, format_tiles(places).encode(), "give --tiles a file that can be written", UsageError)
