"""The monitor's text: events as log lines, the fleet as a table. Pure: events in, text out."""

from collections.abc import Iterable

from rich.console import OverflowMethod
from rich.table import Table
from rich.text import Text

from tilenca.fleet.events import clock_text, port_words
from tilenca.fleet.grid import trouble
from tilenca.fleet.state import Event, Fleet, PortNews, TileView
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.describe import printable, said
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
    )
    return [
        view.port,
        _or_dash(view.tile_id),
        _or_dash(state and (state.label or "nothing")),
        _or_dash(state and state.updates),
        _or_dash(state and f"{state.uptime_ms / 1000:.0f} s"),
        _or_dash(state and state.links),
        *map(_or_dash, counters),
        _or_dash(None if age_s is None else f"{age_s:.1f} s ago"),
        str(view.damaged),
        note,
    ]


def _or_dash(value: object) -> str:
    return "-" if value is None else str(value)


def live_table(fleet: Fleet, now_s: float, overflow: OverflowMethod = "ellipsis") -> Table:
    """The fleet as it is now, for a terminal."""
    picture = Table(box=None, pad_edge=False)
    for name in HEADER:
        picture.add_column(name, no_wrap=True, overflow=overflow)
    for view in fleet.tiles.values():
        row = cells(view, now_s)
        healthy = view.is_open and not row[-1]
        picture.add_row(*map(Text, row), style=None if healthy else "yellow")
    return picture


def summary(tiles: Iterable[TileView]) -> str:
    """The sentences of each port, one row per port."""
    rows = [
        [
            view.port,
            _or_dash(view.tile_id),
            str(view.sentences),
            str(view.damaged),
            str(view.outages),
            ("" if view.is_open else view.reason) or (BOARD_TEST if view.board_test else ""),
        ]
        for view in tiles
    ]
    return table(["PORT", "TILE", "SENTENCES", "BAD LINES", "OUTAGES", "NOTE"], rows)
