"""The monitor's text: events as log lines, the fleet as a table. Pure: events in, text out."""

from collections.abc import Iterable
from pathlib import PurePath

from rich.console import OverflowMethod
from rich.table import Table
from rich.text import Text

from tilenca.fleet.events import clock_text, port_words
from tilenca.fleet.grid import trouble
from tilenca.fleet.ports import natural_key
from tilenca.fleet.side_hints import line_hints
from tilenca.fleet.state import Event, Fleet, PortNews, TileView
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.describe import printable, said
from tilenca.protocol.sentences import missing_side
from tilenca.views.table import table


def log_line(event: Event) -> str:
    """One event as one line: time, port, tile, words."""
    head = f"{clock_text(event.time_s)} {event.port}"
    if isinstance(event, PortNews):
        return f"{head} - PORT {port_words(event)}"
    if event.sentence is None:
        return f"{head} - {event.board_test or f'DAMAGED {printable(event.raw)}'}"
    return f"{head} {said(event.sentence)}"


HEADER = (
    "PORT",
    "TILE",
    "SHOWS",
    "MARGIN",
    "UPDATE",
    "UP",
    "LINKS",
    "RECEIVED",
    "CORRUPT",
    "LOST",
    "HEARD",
    "BAD LINES",
    "NOTE",
)
# What a narrow terminal does without, the first of them first, until the others fit.
SPARED = ("UP", "BAD LINES", "RECEIVED", "HEARD", "CORRUPT", "UPDATE", "LINKS", "LOST")
NOTE_WIDTH = 12  # at most what a note asks for; a longer one takes the room that is left
GAP = 2  # blanks between columns


def cells(view: TileView, now_s: float) -> list[str]:
    """One tile's row under HEADER; `-` for an unknown value."""
    age_s = None if view.heard_s is None else max(now_s - view.heard_s, 0.0)
    state = view.tile
    counters = [view.total(counter) for counter in ("received", "corrupt", "lost")]
    quiet = trouble(view, now_s) == "silent"
    note = (view.reason if not view.is_open else "") or (
        f"speaks protocol {view.other_version}: flash it" if view.other_version else ""
    )
    note = (
        note
        or (BOARD_TEST if view.board_test else "silent" if quiet else "")
        or (view.error.code if view.error else "")
        or _hints(view)
        or _missing(view)
    )
    return [
        view.port,
        _or_dash(view.tile_id),
        _or_dash(state and (state.label or "nothing")),
        _or_dash(state and state.margin),
        _or_dash(state and state.updates),
        _or_dash(state and f"{state.uptime_ms / 1000:.0f} s"),
        _or_dash(state and state.links),
        *map(_or_dash, counters),
        _or_dash(None if age_s is None else f"{age_s:.1f} s ago"),
        str(view.damaged),
        note,
    ]


def _hints(view: TileView) -> str:
    hints = line_hints(view.board, view.board_before) if view.board else {}
    return ", ".join(f"{side} {hint.word}" for side, hint in hints.items())


def _missing(view: TileView) -> str:
    side = missing_side(view.hello, view.tile) if view.hello and view.tile else ""
    return side and f"none at {side}"


def _or_dash(value: object) -> str:
    return "-" if value is None else str(value)


def live_table(fleet: Fleet, now_s: float, width: int, overflow: OverflowMethod = "ellipsis") -> Table:
    """The fleet as it is now, by tiles, in the columns that fit on a terminal of that width."""
    views = by_tile(fleet.tiles.values())
    rows = [dict(zip(HEADER, cells(view, now_s), strict=True)) for view in views]
    names = fitting(rows, width)
    picture = Table(box=None, pad_edge=False, padding=(0, GAP, 0, 0))
    others = [name for name in names if name != "NOTE"]
    for name in others:
        picture.add_column(name, no_wrap=True, overflow=overflow)
    room = max(width - _width(rows, others) - GAP, len("NOTE"))
    picture.add_column("NOTE", no_wrap=True, overflow=overflow, max_width=room)
    for view, row in zip(views, rows, strict=True):
        healthy = view.is_open and not row["NOTE"]
        picture.add_row(*(Text(row[name]) for name in names), style=None if healthy else "yellow")
    return picture


def fitting(rows: list[dict[str, str]], width: int) -> list[str]:
    """The names of the columns that fit; where not all do, the ports' folders go first, from the rows."""
    names = list(HEADER)
    if _width(rows, names) > width:
        short = [PurePath(row["PORT"]).name for row in rows]
        for row, name in zip(rows, short, strict=True):
            row["PORT"] = name if short.count(name) == 1 else row["PORT"]
    for spared in SPARED:
        if _width(rows, names) <= width:
            break
        names.remove(spared)
    return names


def _width(rows: list[dict[str, str]], names: list[str]) -> int:
    widest = {name: max(len(row[name]) for row in [{name: name}, *rows]) for name in names}
    if "NOTE" in widest:
        widest["NOTE"] = min(widest["NOTE"], NOTE_WIDTH)
    return sum(widest.values()) + GAP * (len(names) - 1)


def by_tile(views: Iterable[TileView]) -> list[TileView]:
    """In the order of the tiles' ids, those without one last."""
    return sorted(views, key=lambda view: (not view.tile_id, view.tile_id or 0, natural_key(view.port)))


def summary(tiles: Iterable[TileView]) -> str:
    """The sentences of each port, one row per port, in the order of the tiles."""
    rows = [
        [
            view.port,
            _or_dash(view.tile_id),
            str(view.sentences),
            str(view.damaged),
            str(view.outages),
            ("" if view.is_open else view.reason) or (BOARD_TEST if view.board_test else ""),
        ]
        for view in by_tile(tiles)
    ]
    return table(["PORT", "TILE", "SENTENCES", "BAD LINES", "OUTAGES", "NOTE"], rows)
