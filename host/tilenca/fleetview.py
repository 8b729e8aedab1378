"""What the monitor shows: events as log lines, the fleet as a table. Pure: events in, text out."""

import time
from collections.abc import Iterable

from rich.table import Table
from rich.text import Text

from tilenca.protocol import HelloSentence, LinkSentence, Sentence, TileSentence
from tilenca.tables import table
from tilenca.telemetry import Event, Fleet, PortNews, TileView, type_of

# A tile that said nothing for so long, and for two of its periods where we know them, may be in trouble.
QUIET_S = 3.0
SHOWN_BYTES = 60


def clock_text(time_s: float) -> str:
    """Local time of day with milliseconds."""
    milliseconds = round(time_s * 1000)
    return time.strftime("%H:%M:%S", time.localtime(milliseconds // 1000)) + f".{milliseconds % 1000:03d}"


def log_line(event: Event) -> str:
    """One event as one line: time, port, tile, what it says."""
    head = f"{clock_text(event.time_s)} {event.port}"
    if isinstance(event, PortNews):
        return f"{head} - PORT {'open' if event.is_open else event.reason}"
    if event.sentence is None:
        return f"{head} - DAMAGED {printable(event.raw)}"
    return f"{head} tile {event.sentence.tile} {type_of(event.sentence)} {_words(event.sentence)}"


def printable(raw: bytes) -> str:
    """Bytes as text that cannot disturb a terminal, cut to a readable length."""
    text = repr(raw[:SHOWN_BYTES])[2:-1]
    return text if len(raw) <= SHOWN_BYTES else f"{text}... ({len(raw)} bytes)"


def _words(sentence: Sentence) -> str:
    match sentence:
        case TileSentence(_, uptime_ms, updates, label, links, _):
            return f"shows {label or 'nothing'} update {updates} up {uptime_ms / 1000:.1f} s links {links}"
        case LinkSentence(_, _, side, sent, received, corrupt, lost, foreign, age_ms):
            counts = f"sent {sent} received {received} corrupt {corrupt} lost {lost} foreign {foreign}"
            return f"{side} {counts} age {'never' if age_ms is None else f'{age_ms} ms'}"
        case HelloSentence(version, _, model_id, channels, classes, period_ms, updates, reset_cause):
            model = f"model {model_id:04X} ({channels} channels, {classes} classes)"
            limit = f"{updates} updates" if updates else "for ever"
            return f"protocol {version} {model} every {period_ms} ms {limit} reset cause {reset_cause:02X}"


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
    """One tile's row under HEADER; `-` for what is not known."""
    age_s = None if view.heard_s is None else max(now_s - view.heard_s, 0.0)
    state = view.tile
    counters = [view.total(counter) for counter in ("received", "corrupt", "lost")]
    note = view.reason or ("silent" if view.is_open and (age_s is None or age_s > _patience_s(view)) else "")
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


def _patience_s(view: TileView) -> float:
    return max(QUIET_S, 2 * view.hello.period_ms / 1000 if view.hello else 0.0)


def _or_dash(value: object) -> str:
    return "-" if value is None else str(value)


def live_table(fleet: Fleet, now_s: float) -> Table:
    """The fleet as it is now, for a terminal."""
    picture = Table(box=None, pad_edge=False)
    for name in HEADER:
        picture.add_column(name, no_wrap=True)
    for view in fleet.tiles.values():
        row = cells(view, now_s)
        healthy = view.is_open and not row[-1]
        picture.add_row(*map(Text, row), style=None if healthy else "yellow")
    return picture


def summary(tiles: Iterable[TileView]) -> str:
    """What was heard, one row per port."""
    rows = [
        [
            view.port,
            _or_dash(view.tile_id),
            str(view.sentences),
            str(view.damaged),
            str(view.outages),
            view.reason,
        ]
        for view in tiles
    ]
    return table(["PORT", "TILE", "SENTENCES", "BAD LINES", "OUTAGES", "NOTE"], rows)
