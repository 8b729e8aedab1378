"""The log of a fleet: each change with its time and its tile. Pure: events in, news out."""

import time
from dataclasses import dataclass

from tilenca.base.sides import SIDES
from tilenca.fleet.grid import Grid
from tilenca.fleet.link_health import FAILING, WELL
from tilenca.fleet.side_hints import SUPPLY_REMEDY, SideHint, line_hints, silence_hints
from tilenca.fleet.state import Event, Fleet, PortNews, TileView
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.describe import printable, words
from tilenca.protocol.sentences import (
    AckSentence,
    BoardSentence,
    ChipSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    TileSentence,
)

# Tiles that have just started do not hear each other yet.
SILENCE_LOOK_S, SILENCE_LOOKS = 1.0, 3
# The same as for a whole fleet: see `tell_models`.
REMEDY = "flash the one that differs from most (tilenca flash)"
GARBLED = "no frame of it arrives whole: check the plug, and that both run one model"


@dataclass(frozen=True)
class News:
    """One line of the log; `tile` is None while unknown, `bad` marks lines that need a person's attention."""

    time_s: float
    port: str
    tile: int | None
    text: str
    bad: bool = False


def news_line(news: News, port: str | None = None) -> str:
    """News as one line, the port by another name if one is given."""
    tile = "-" if news.tile is None else str(news.tile)
    return f"{clock_text(news.time_s)} tile {tile:>3} {port or news.port} {news.text}"


class Reporter:
    """Watches a fleet and reports the changes that each event brings.

    With a grid it also tells of tiles that lie side by side and do not hear each other.
    """

    def __init__(self, fleet: Fleet, grid: Grid | None = None) -> None:
        self._fleet = fleet
        self._silence = SilenceWatch(fleet, grid) if grid else None
        self._hinted: dict[tuple[str, str], SideHint] = {}
        self._label: dict[str, str] = {}
        self._other: dict[str, int] = {}  # the protocol of another version that was told
        self._links: dict[str, str] = {}
        self._failing: set[tuple[str, str]] = set()
        self._foreign: set[tuple[str, str]] = set()
        self._garbled: set[tuple[str, str]] = set()  # no frame of a neighbour arrives whole

    def take(self, event: Event) -> list[News]:
        """The news of an event that the fleet has just taken."""
        view = self._fleet.tiles[event.port]
        told = [
            News(event.time_s, event.port, view.tile_id, text, bad) for text, bad in self._tell(event, view)
        ]
        return told + (self._silence.look(event.time_s) if self._silence else [])

    def _tell(self, event: Event, view: TileView) -> list[tuple[str, bool]]:
        if isinstance(event, PortNews):
            self._other.pop(event.port, None)
            return [(f"port {port_words(event)}", not event.is_open)]
        match event.sentence:
            case None if event.board_test:
                return [(f"{BOARD_TEST}: {event.board_test}", "FAIL" in event.board_test)]
            case None:
                return [(f"damaged: {printable(event.raw)}", True)]
            case HelloSentence() as hello:
                self._other.pop(event.port, None)
                self._label[event.port], self._links[event.port] = "", "----"
                self._failing -= {(event.port, side) for side in SIDES}
                self._foreign -= {(event.port, side) for side in SIDES}
                self._garbled -= {(event.port, side) for side in SIDES}
                return [(f"started: {words(hello)}", False)]
            case TileSentence() as tile:
                return [*self._label_news(event.port, tile), *self._link_news(event.port, tile)]
            case LinkSentence() as link:
                return [
                    *self._foreign_news(event.port, link, view),
                    *self._health_news(event.port, link, view),
                ]
            case OtherVersionSentence() as other:
                return self._version_news(event.port, other)
            case BoardSentence() as board:
                return self._line_news(event.port, board, view)
            case ChipSentence() as chip:
                return [] if chip.revision is None else [(words(chip), False)]
            case ErrorSentence(_, _, "SUPPLY", text):
                return [(f"SUPPLY {text}: {SUPPLY_REMEDY}", True)]
            case ErrorSentence() | NakSentence() as complaint:
                return [(words(complaint), True)]
            case AckSentence() as done:
                return [(words(done), False)]
        return []

    def _version_news(self, port: str, other: OtherVersionSentence) -> list[tuple[str, bool]]:
        before, self._other[port] = self._other.get(port), other.version
        return [] if before == other.version else [(words(other), True)]

    def _label_news(self, port: str, tile: TileSentence) -> list[tuple[str, bool]]:
        before, self._label[port] = self._label.get(port), tile.label
        if before == tile.label:
            return []
        what = tile.label or "nothing"
        return [(f"shows {what}, before {before}" if before else f"shows {what}", False)]

    def _link_news(self, port: str, tile: TileSentence) -> list[tuple[str, bool]]:
        before, self._links[port] = self._links.get(port), tile.links
        if before is None or before == tile.links:
            return []
        gone = "".join(old for old, new in zip(before, tile.links, strict=True) if new == "-" != old)
        come = "".join(new for old, new in zip(before, tile.links, strict=True) if old == "-" != new)
        lost = [(f"lost its neighbour on {' '.join(gone)}", True)] if gone else []
        return [*lost, *([(f"hears a neighbour on {' '.join(come)}", False)] if come else [])]

    def _foreign_news(self, port: str, link: LinkSentence, view: TileView) -> list[tuple[str, bool]]:
        health, key = view.health.get(link.side), (port, link.side)
        foreign = health is not None and health.foreign
        if foreign == (key in self._foreign):
            return []
        self._foreign ^= {key}
        if foreign:
            return [(f"a tile with another model is on {link.side}: {REMEDY}", True)]
        return [(f"no other model is on {link.side} any more", False)]

    def _line_news(self, port: str, board: BoardSentence, view: TileView) -> list[tuple[str, bool]]:
        hints = line_hints(board, view.board_before)
        news = []
        for side in SIDES:
            before, now = self._hinted.get((port, side)), hints.get(side)
            if now is not None and now is not before:
                self._hinted[port, side] = now
                news.append((f"side {side}: {now.text}", True))
            elif now is None and before is not None:
                del self._hinted[port, side]
                news.append((f"side {side}: not so any more ({before.fact})", False))
        return news

    def _health_news(self, port: str, link: LinkSentence, view: TileView) -> list[tuple[str, bool]]:
        health, key = view.health.get(link.side), (port, link.side)
        if health is None:
            return []
        if health.garbled != (key in self._garbled):
            self._garbled ^= {key}
            if health.garbled:
                return [(f"on {link.side} is a tile, but {GARBLED}", True)]
            return [(f"frames from {link.side} are not garbled any more", False)]
        good = health.good
        if good is None:
            return []
        if good < FAILING and key not in self._failing:
            self._failing.add(key)
            return [(f"link {link.side} is failing: {1 - good:.0%} of the frames get lost", True)]
        if good >= WELL and key in self._failing:
            self._failing.discard(key)
            return [(f"link {link.side} is well again", False)]
        return []


class SilenceWatch:
    """Finds tiles that lie side by side and do not hear each other, and tells it once."""

    def __init__(self, fleet: Fleet, grid: Grid) -> None:
        self._fleet, self._grid = fleet, grid
        self._next_s = 0.0
        self._seen: dict[str, tuple[str, int]] = {}  # per port: the text, and how often in succession

    def look(self, now_s: float) -> list[News]:
        """The news, if it is time to look again."""
        if self._next_s - SILENCE_LOOK_S <= now_s < self._next_s:  # else also where a replay went back
            return []
        self._next_s = now_s + SILENCE_LOOK_S
        seen, news = {}, []
        for cell in self._grid.cells(self._fleet, now_s).values():
            view = None if cell.port is None else self._fleet.tiles.get(cell.port)
            hints = silence_hints(view, cell.unheard) if view else {}
            if cell.port is None or not hints:
                continue
            text = f"{' '.join(hints)}: {next(iter(hints.values())).text}"
            before, count = self._seen.get(cell.port, ("", 0))
            seen[cell.port] = text, count + 1 if before == text else 1
            if seen[cell.port][1] == SILENCE_LOOKS:
                news.append(News(now_s, cell.port, cell.tile, f"does not hear its neighbour on {text}", True))
        self._seen = seen
        return news


def clock_text(time_s: float) -> str:
    """Local time of day with milliseconds."""
    milliseconds = round(time_s * 1000)
    return time.strftime("%H:%M:%S", time.localtime(milliseconds // 1000)) + f".{milliseconds % 1000:03d}"


def port_words(news: PortNews) -> str:
    """The news of a port, in words."""
    return "; ".join(filter(None, ("open" if news.is_open else "", news.reason)))
