"""The state of every tile of the fleet, built up from its sentences. Owns no port and no clock."""

from dataclasses import dataclass, field
from typing import Any, TypeAlias

from tilenca.fleet.link_health import LinkHealth
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    BoardSentence,
    ChipSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
    type_of,
)


@dataclass(frozen=True)
class PortNews:
    """A port was opened, or cannot be read for `reason`."""

    time_s: float
    port: str
    is_open: bool
    reason: str = ""


Event: TypeAlias = Heard | PortNews


def as_json(heard: Heard) -> dict[str, Any]:
    """A good line as one JSON object; `state`, `model_id` and `firmware_id` are hex as on the wire.

    Raises:
        ValueError: the line is damaged.
    """
    if heard.sentence is None:
        raise ValueError("a damaged line has no fields")
    fields = {k: v.hex().upper() if isinstance(v, bytes) else v for k, v in vars(heard.sentence).items()}
    if isinstance(heard.sentence, HelloSentence):
        fields["model_id"] = f"{heard.sentence.model_id:04X}"
        fields["firmware_id"] = f"{heard.sentence.firmware_id:08X}"
    tile = fields.pop("tile")
    kind = type_of(heard.sentence)
    return {"time": round(heard.time_s, 3), "port": heard.port, "tile": tile, "type": kind, "fields": fields}


@dataclass
class TileView:
    """The known state of the tile behind one port.

    Attributes:
        port: the port.
        is_open: whether it can be read now; `reason` tells why not.
        was_open: whether it could be read at any time.
        outages: how often it went away.
        sentences: good lines.
        damaged: damaged lines.
        heard_s: time of the last good line; None before the first.
        hello: the tile's greeting at boot; None if we missed it.
        tile: its last state.
        links: the last report of each side, by letter.
        health: the recent quality of each side's link, by letter.
        time: its last report of its time and memory.
        board: what it measures on its board, and `board_before` the report before that, since its HELLO.
        chip: its fuses, and its board's marking.
        error: the last error that it reported since its HELLO.
        other_version: its protocol version, if it is not ours.
        board_test: whether its last line was the board test's.
    """

    port: str
    is_open: bool = False
    was_open: bool = False
    reason: str = ""
    outages: int = 0
    sentences: int = 0
    damaged: int = 0
    heard_s: float | None = None
    hello: HelloSentence | None = None
    tile: TileSentence | None = None
    links: dict[str, LinkSentence] = field(default_factory=dict)
    health: dict[str, LinkHealth] = field(default_factory=dict)
    time: TimeSentence | None = None
    board: BoardSentence | None = None
    board_before: BoardSentence | None = None
    chip: ChipSentence | None = None
    error: ErrorSentence | None = None
    other_version: int | None = None
    tile_id: int | None = None
    board_test: bool = False

    def total(self, counter: str) -> int | None:
        """The sum over the sides of a counter of `LinkSentence`; None before the first report."""
        return sum(getattr(link, counter) for link in self.links.values()) if self.links else None

    def take(self, event: Event) -> None:
        """Adds an event of this port."""
        if isinstance(event, PortNews):
            self.outages += self.is_open and not event.is_open
            self.is_open, self.reason = event.is_open, event.reason
            self.was_open |= event.is_open
            return
        if not self.outages:  # recordings of emulated tiles have no news of ports
            self.is_open = self.was_open = True
        if event.sentence is None:
            self.board_test = event.board_test is not None
            self.damaged += not self.board_test
        else:
            self.sentences += 1
            self.board_test = False
            self.heard_s = event.time_s
            self._hear(event.sentence)

    def _hear(self, sentence: Sentence) -> None:
        self.tile_id = sentence.tile
        match sentence:
            case HelloSentence():
                # The tile may have just started: earlier reports no longer hold.
                self.hello, self.tile, self.links, self.health = sentence, None, {}, {}
                self.time = self.error = self.other_version = self.board = self.board_before = None
            case TileSentence():
                self.tile = sentence
            case LinkSentence():
                self.links[sentence.side] = sentence
                self.health.setdefault(sentence.side, LinkHealth()).take(sentence)
            case TimeSentence():
                self.time = sentence
            case BoardSentence():
                self.board_before, self.board = self.board, sentence
            case ChipSentence():
                self.chip = sentence
            case ErrorSentence():
                self.error = sentence
            case OtherVersionSentence():
                self.other_version = sentence.version


class Fleet:
    """The tiles of all ports, in the order the ports were first met."""

    def __init__(self) -> None:
        self.tiles: dict[str, TileView] = {}

    def take(self, event: Event) -> None:
        """Adds an event."""
        self.tiles.setdefault(event.port, TileView(event.port)).take(event)
