"""What tiles say on USB: bytes in, events out, and what they add up to. Owns no port and no clock."""

import re
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from tilenca.boardtest import board_test_text
from tilenca.linkhealth import LinkHealth
from tilenca.protocol import (
    MAX_SENTENCE,
    AckSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
    parse_sentence,
)

TYPES = {
    HelloSentence: "HELLO",
    TileSentence: "TILE",
    LinkSentence: "LINK",
    TimeSentence: "TIME",
    ErrorSentence: "ERROR",
    AckSentence: "ACK",
    NakSentence: "NAK",
    OtherVersionSentence: "OTHER",
}

# A sentence begins at `$` and ends with two digits after `*`; whether it is one, its checksum says.
_CANDIDATE = re.compile(rb"\$[^*]*\*..", re.DOTALL)
_BREAK = re.compile(rb"[\r\n]+|(?=\$)")


class LineReader:
    """Cuts a stream of bytes into sentences and the damaged rest.

    Nothing is lost in silence: every byte that is not part of a good sentence nor white space is in a damaged
    line, but for the tail of a line that one began to read in its middle.
    """

    def __init__(self) -> None:
        self._buffer = b""
        self._joined_midway = True

    def feed(self, data: bytes) -> list[tuple[bytes, Sentence | None]]:
        """The lines that `data` completed: raw bytes, and the sentence or None if damaged; never raises."""
        *pieces, self._buffer = _BREAK.split(self._buffer + data)
        if len(self._buffer) > MAX_SENTENCE:
            pieces.append(self._buffer)
            self._buffer = b""
        lines = []
        for piece in filter(None, map(bytes.strip, pieces)):
            found = _lines(piece)
            if not self._joined_midway or piece.startswith(b"$") or board_test_text(piece):
                lines += found
            self._joined_midway = False
        return lines


def _lines(piece: bytes) -> list[tuple[bytes, Sentence | None]]:
    candidate = _CANDIDATE.match(piece)
    sentence = parse_sentence(candidate[0]) if candidate else None
    if candidate is None or sentence is None:
        return [(piece, None)]
    rest = piece[candidate.end() :].strip()
    return [(candidate[0], sentence), *([(rest, None)] if rest else [])]


@dataclass(frozen=True)
class Heard:
    """One line from a port.

    Attributes:
        time_s: when, in seconds since 1970.
        port: whence.
        raw: the line's bytes, without its end.
        sentence: what it says; None if it is damaged, or the board test's.
    """

    time_s: float
    port: str
    raw: bytes
    sentence: Sentence | None

    @property
    def board_test(self) -> str | None:
        """What the board test says in this line; None if it is not of it."""
        return board_test_text(self.raw)


@dataclass(frozen=True)
class PortNews:
    """A port was opened, or cannot be read; `reason` says why not."""

    time_s: float
    port: str
    is_open: bool
    reason: str = ""


Event: TypeAlias = Heard | PortNews


def type_of(sentence: Sentence) -> str:
    """The sentence's name on the wire; `OTHER` for one of another protocol version."""
    return TYPES[type(sentence)]


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
    """All that is known of the tile behind one port.

    Attributes:
        port: the port.
        is_open: whether it can be read now; `reason` why not.
        was_open: whether it ever could.
        outages: how often it went away.
        sentences: good lines.
        damaged: damaged lines.
        heard_s: time of the last good line; None before the first.
        hello: what the tile said at boot, if we heard that.
        tile: its last state.
        links: the last report of each side, by letter.
        health: how each side's link did lately, by letter.
        time: its last report of its time and memory.
        error: the last thing it said to be wrong since its HELLO.
        other_version: the protocol it speaks, if it is not ours.
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
        elif event.sentence is None:
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
                # The tile may have just started: what it said before is no longer so.
                self.hello, self.tile, self.links, self.health = sentence, None, {}, {}
                self.time = self.error = self.other_version = None
            case TileSentence():
                self.tile = sentence
            case LinkSentence():
                self.links[sentence.side] = sentence
                self.health.setdefault(sentence.side, LinkHealth()).take(sentence)
            case TimeSentence():
                self.time = sentence
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
