"""The sentences on USB (docs/PROTOCOL.md section 3): text in, dataclasses out, and back.

No port and no clock. `protocol.commands` has the host's sentences, `protocol.frames` the tiles' frames.
"""

import re

from tilenca.base.sides import SIDES
from tilenca.protocol import patterns
from tilenca.protocol.checksums import checksum
from tilenca.protocol.constants import PROTOCOL_VERSION
from tilenca.protocol.sentence_types import (
    AckSentence,
    BoardSentence,
    ChipSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
    missing_side,
)

__all__ = [
    "TYPES",
    "AckSentence",
    "BoardSentence",
    "ChipSentence",
    "ErrorSentence",
    "HelloSentence",
    "LinkSentence",
    "NakSentence",
    "OtherVersionSentence",
    "Sentence",
    "TileSentence",
    "TimeSentence",
    "format_sentence",
    "framed",
    "missing_side",
    "parse_sentence",
    "sentence_of",
    "type_of",
]


def framed(text: str) -> bytes:
    """`text` as a sentence on the wire: between `$` and `*`, with checksum and CR LF."""
    body = text.encode("ascii")
    return b"$%s*%02X\r\n" % (body, checksum(body))


def format_sentence(sentence: Sentence) -> bytes:
    """The sentence as a tile writes it, CR LF included.

    Raises:
        ValueError: the fields of another version's sentences are unknown.
    """
    fields: tuple[object, ...]
    match sentence:
        case HelloSentence() as hello:
            fields = (
                f"HELLO,{hello.version}",
                hello.tile,
                f"{hello.model_id:04X},{hello.channels},{hello.classes},{hello.period_ms},{hello.updates}",
                f"{hello.reset_cause:02X},{hello.firmware_id:08X},{hello.brightness}",
                *([hello.directions] if hello.directions else []),
            )
        case TileSentence():
            fields = ("TILE", *list(vars(sentence).values())[:-1], sentence.state.hex().upper())
        case LinkSentence():
            fields = ("LINK", *vars(sentence).values())
        case TimeSentence():
            fields = ("TIME", *vars(sentence).values())
        case ChipSentence(tile, low, high, extended, lock, revision, serial):
            fields = ("CHIP", tile, f"{low:02X},{high:02X},{extended:02X},{lock:02X}", revision, serial)
        case BoardSentence(tile, uptime_ms, supply_mv, framing_errors, low_ms):
            fields = ("BOARD", tile, uptime_ms, supply_mv, *framing_errors, *low_ms)
        case ErrorSentence(tile, uptime_ms, code, text):
            fields = ("ERROR", tile, uptime_ms, code, text)
        case AckSentence(tile, command, values):
            fields = ("ACK", tile, command, *values)
        case NakSentence(tile, reason, command):
            fields = ("NAK", tile, reason, command)
        case OtherVersionSentence(version):
            raise ValueError(f"protocol {version} is not spoken here")
    return framed(",".join("" if value is None else str(value) for value in fields))


def parse_sentence(line: bytes | str) -> Sentence | None:
    """The sentence in a line; None for noise, damage, or an unknown name.

    Never raises. White space around the sentence (CR LF) is ignored.
    """
    raw = line.encode("ascii", "replace") if isinstance(line, str) else line
    match = patterns.SENTENCE.fullmatch(raw.strip())
    return sentence_of(match) if match else None


def sentence_of(match: re.Match[bytes]) -> Sentence | None:
    """The sentence that `patterns.SENTENCE` found; None for damage, or an unknown name."""
    if checksum(match[1]) != int(match[2], 16):
        return None
    text = match[1].decode("ascii")
    parse = _PARSERS.get(text.partition(",")[0])
    return parse(text) if parse else None


def _hello(text: str) -> Sentence | None:
    if (found := patterns.HELLO.fullmatch(text)) and int(found[1]) == PROTOCOL_VERSION:
        version, tile, model_id, channels, classes, period_ms, updates, cause, firmware, light, directions = (
            found.groups(default="0")
        )
        numbers = int(channels), int(classes), int(period_ms), int(updates)
        ids = int(cause, 16), int(firmware, 16), int(light), int(directions)
        return HelloSentence(int(version), int(tile), int(model_id, 16), *numbers, *ids)
    if (found := patterns.OTHER_HELLO.fullmatch(text)) and int(found[1]) != PROTOCOL_VERSION:
        return OtherVersionSentence(int(found[1]), int(found[2]))
    return None


def _tile(text: str) -> Sentence | None:
    if found := patterns.TILE_2.fullmatch(text):
        return OtherVersionSentence(2, int(found[1]))
    if (found := patterns.TILE.fullmatch(text)) is None:
        return None
    tile, uptime_ms, updates, label, decided, margin, links, state = found.groups()
    if bool(label) != bool(decided) or (margin and not decided):
        return None
    return TileSentence(
        int(tile), int(uptime_ms), int(updates), label, int(decided) if decided else None,
        int(margin) if margin else None, links, bytes.fromhex(state),
    )  # fmt: skip


def _link(text: str) -> Sentence | None:
    if found := patterns.LINK.fullmatch(text):
        tile, uptime_ms, side, *counts, age, overruns, neighbour, neighbour_side = found.groups()
        sent, received, corrupt, lost, foreign = map(int, counts)
        return LinkSentence(
            int(tile), int(uptime_ms), side, sent, received, corrupt, lost, foreign,
            int(age) if age else None, int(overruns), int(neighbour) if neighbour else None, neighbour_side,
        )  # fmt: skip
    return OtherVersionSentence(1, int(found[1])) if (found := patterns.LINK_1.fullmatch(text)) else None


def _time(text: str) -> Sentence | None:
    return TimeSentence(*map(int, found.groups())) if (found := patterns.TIME.fullmatch(text)) else None


def _chip(text: str) -> Sentence | None:
    if (found := patterns.CHIP.fullmatch(text)) is None:
        return None
    tile, *fuses, revision, serial = found.groups()
    if bool(revision) != bool(serial):
        return None
    marking = (int(revision), int(serial)) if revision else ()
    return ChipSentence(int(tile), *(int(value, 16) for value in fuses), *marking)


def _board(text: str) -> Sentence | None:
    if (found := patterns.BOARD.fullmatch(text)) is None:
        return None
    tile, uptime_ms, supply, *sides = found.groups()
    counts = tuple(map(int, sides))
    return BoardSentence(
        int(tile), int(uptime_ms), int(supply) if supply else None, counts[: len(SIDES)], counts[len(SIDES) :]
    )


def _error(text: str) -> Sentence | None:
    found = patterns.ERROR.fullmatch(text)
    return ErrorSentence(int(found[1]), int(found[2]), found[3], found[4]) if found else None


def _ack(text: str) -> Sentence | None:
    if (found := patterns.ACK.fullmatch(text)) is None:
        return None
    return AckSentence(int(found[1]), found[2], tuple(found[3].split(",")[1:]))


def _nak(text: str) -> Sentence | None:
    found = patterns.NAK.fullmatch(text)
    return NakSentence(int(found[1]), found[2], found[3]) if found else None


_PARSERS = {
    "HELLO": _hello,
    "TILE": _tile,
    "LINK": _link,
    "TIME": _time,
    "CHIP": _chip,
    "BOARD": _board,
    "ERROR": _error,
    "ACK": _ack,
    "NAK": _nak,
}


TYPES = {
    HelloSentence: "HELLO",
    TileSentence: "TILE",
    LinkSentence: "LINK",
    TimeSentence: "TIME",
    ChipSentence: "CHIP",
    BoardSentence: "BOARD",
    ErrorSentence: "ERROR",
    AckSentence: "ACK",
    NakSentence: "NAK",
    OtherVersionSentence: "OTHER",
}


def type_of(sentence: Sentence) -> str:
    """The sentence's name on the wire; `OTHER` for one of another protocol version."""
    return TYPES[type(sentence)]
