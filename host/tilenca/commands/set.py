"""`tilenca set`: one setting in one, some or all tiles, acknowledged and read back."""

import argparse
import json
from dataclasses import dataclass
from typing import Any

from tilenca.base.errors import NoDeviceError, UsageError
from tilenca.base.stdio import warn
from tilenca.commands.arguments import add_fleet_arguments
from tilenca.fleet.boards import Found, find_fleet, tell_contradiction, tile_numbers
from tilenca.fleet.command import command_all
from tilenca.fleet.identify import ask
from tilenca.fleet.reader import PortReader
from tilenca.protocol.commands import mark_command, set_command
from tilenca.protocol.constants import PRESETS, SETTING_RANGES
from tilenca.protocol.describe import whole_number
from tilenca.protocol.sentences import HelloSentence
from tilenca.views.table import table

USER = "tilenca set"
HEADER = ("PORT", "TILE", "RESULT", "ID", "PERIOD", "UPDATES", "BRIGHTNESS", "WHY")
# What of a HELLO each setting is; a HELLO does not tell `leds`, and the tile's acknowledgement is enough.
FIELDS = {"id": "tile", "period": "period_ms", "updates": "updates", "brightness": "brightness"}
LEDS_MISSING = 2
NO_DIRECTIONS = "its model does not say where a tile is missing; flash one trained with --recipe damage"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    ranges = "; ".join(f"{name} {low} to {high}" for name, (low, high) in SETTING_RANGES.items())
    parser.add_argument("name", metavar="NAME", help=f"{', '.join(SETTING_RANGES)}, preset or board")
    parser.add_argument(
        "value",
        metavar="VALUE",
        help=f"{ranges}; preset {' or '.join(PRESETS)}; board REVISION.SERIAL, of one tile, for good",
    )
    add_fleet_arguments(parser)
    parser.add_argument(
        "--tile", action="append", metavar="N", help="only this tile, or a list like 3,7,9-12; repeatable"
    )
    parser.add_argument("--replace", action="store_true", help="with board: replace another marking")
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


@dataclass
class SettingRow:
    """The result of one tile; `hello` is its last greeting; without a port it is not connected."""

    port: str | None
    tile: int | None
    result: str = "failed"
    error: str | None = None
    hello: HelloSentence | None = None


def run(args: argparse.Namespace) -> int:
    """Sets it everywhere at once; see `tilenca set --help`."""
    try:
        value, order = _order(args)
    except ValueError as error:
        raise UsageError(f"{error}; see tilenca set --help") from error
    wanted = set[int]().union(*map(tile_numbers, args.tile)) if args.tile else None
    found = find_fleet(args.port, args.tiles)
    found.tell_others()
    listed = {board.port.name: board.tile for board in found.boards}
    # Opening its port may reset a tile: those that are known not to be meant are left in peace.
    rows = {
        name: SettingRow(name, tile)
        for name, tile in listed.items()
        if wanted is None or tile is None or tile in wanted
    }
    asked = rows
    with PortReader(list(rows), user=USER) as reader:
        rows = _known(reader, rows, wanted)
        if args.name == "id" and value != 0:
            _check_id(value, rows, _others(found, asked, rows))
        if args.name == "board" and len(rows) > 1:
            raise UsageError(f"{len(rows)} boards would be the same; choose one with --tile or --port")
        _set(reader, rows, args.name, value, order)
    if args.name in ("period", "preset"):
        _compare_periods([asked.get(name) or SettingRow(name, None) for name in listed])
    for port, row in rows.items():
        if listed[port] is None and row.hello:
            row.tile = row.hello.tile or None
        tell_contradiction(port, listed[port], row.hello)
    absent = [
        SettingRow(None, place.tile, "missing", f"not connected ({place.board}); connect it and set again")
        for place in found.missing
        if wanted is None or place.tile in wanted
    ]
    everything = [*rows.values(), *absent]
    _print(everything, args.json)
    return 0 if all(row.result == "set" for row in everything) else 1


def _order(args: argparse.Namespace) -> tuple[int | str, bytes]:
    """The value, and the command for it.

    Raises:
        ValueError: no tile takes it.
    """
    if args.replace and args.name != "board":
        raise ValueError("--replace does nothing without board; leave it out")
    if args.name == "board":
        revision, serial = (whole_number(part) for part in (args.value.partition(".")[::2]))
        if revision is None or serial is None:
            raise ValueError(f"board '{args.value}': it is REVISION.SERIAL, such as 2.17")
        return args.value, mark_command(revision, serial, args.replace)
    number = None if args.name == "preset" else whole_number(args.value)
    value = args.value if number is None else number
    return value, set_command(args.name, value)


def _others(found: Found, asked: dict[str, SettingRow], chosen: dict[str, SettingRow]) -> set[int | None]:
    """The ids of all tiles but the chosen ones, as far as they are known: by the file, and as tiles say."""
    others = [board for board in found.boards if board.port.name not in chosen]
    said = [row.hello.tile for board in others if (row := asked.get(board.port.name)) and row.hello]
    return {*said, *(board.tile for board in others), *(place.tile for place in found.missing)}


def _check_id(value: int | str, rows: dict[str, SettingRow], others: set[int | None]) -> None:
    """Refuses to give two tiles the same id.

    Raises:
        UsageError: it would.
    """
    if len(rows) > 1:
        raise UsageError(f"{len(rows)} tiles would have the same id; choose one with --tile or --port")
    if value in others:
        raise UsageError(f"there is a tile {value} already; give that one another id first, or this one")


def _compare_periods(rows: list[SettingRow]) -> None:
    """Says if tiles of the fleet have different periods, or may have."""
    periods = {row.hello.period_ms if row.hello else None for row in rows}
    if len(periods) > 1:
        known = ", ".join(str(period) for period in sorted(filter(None, periods)))
        rest = ", others not known" if None in periods else ""
        warn(
            f"tiles may have different periods now ({known} ms{rest}): such neighbours agree more slowly; "
            "without --tile and --port it is set in all"
        )


def _known(reader: PortReader, rows: dict[str, SettingRow], wanted: set[int] | None) -> dict[str, SettingRow]:
    """The rows of the tiles that are meant, with what each says of itself now.

    Raises:
        NoDeviceError: none of them is there.
    """
    for port, answer in ask(reader, rows).items():
        row = rows[port]
        row.hello, row.error = answer.hello, answer.problem or None
        row.tile = row.tile or (answer.hello.tile if answer.hello else None)
    chosen = {port: row for port, row in rows.items() if wanted is None or row.tile in wanted}
    if not chosen:
        raise NoDeviceError(
            f"no tile {', '.join(map(str, sorted(wanted or ())))} answers; `tilenca monitor` shows which do"
        )
    return chosen


def _set(reader: PortReader, rows: dict[str, SettingRow], name: str, value: int | str, order: bytes) -> None:
    """Sets it in all tiles that answered, and asks each what is in force then."""
    speaking = {port: order for port, row in rows.items() if row.hello}
    replies = command_all(reader, speaking, "MARK" if name == "board" else "SET")
    done = [port for port, reply in replies.items() if not reply.problem]
    for port, reply in replies.items():
        row = rows[port]
        row.error = reply.problem or None
        if (
            reply.problem
            and (name, value) == ("leds", LEDS_MISSING)
            and row.hello
            and not row.hello.directions
        ):
            row.error = NO_DIRECTIONS
    for port, answer in ask(reader, done).items():
        row = rows[port]
        row.hello, row.error = answer.hello or row.hello, answer.problem or None
        if answer.hello is None:
            continue
        if name in FIELDS and getattr(answer.hello, FIELDS[name]) != value:
            row.error = f"acknowledged, but {name} is {getattr(answer.hello, FIELDS[name])}"
            continue
        row.result = "set"


def _print(rows: list[SettingRow], as_json: bool) -> None:
    if as_json:
        print(json.dumps({"tiles": [_document(row) for row in rows]}, indent=2))
        return
    lines = []
    for row in rows:
        settings = [str(value) for value in _settings(row).values()] or ["-"] * len(FIELDS)
        lines.append([row.port or "-", str(row.tile or "-"), row.result, *settings, row.error or ""])
    print(table(HEADER, lines))


def _settings(row: SettingRow) -> dict[str, int]:
    return {name: getattr(row.hello, field) for name, field in FIELDS.items()} if row.hello else {}


def _document(row: SettingRow) -> dict[str, Any]:
    about = {"port": row.port, "tile": row.tile, "result": row.result, "error": row.error}
    return {**about, "settings": _settings(row) or None}
