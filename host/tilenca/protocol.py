"""Every byte that leaves a tile: docs/PROTOCOL.md in Python, twin of the firmware's core and app.

Constants have the names they have in C++: `kMaxSentence` there is `MAX_SENTENCE` here. Pure standard library,
no port, no clock: bytes go in, frames and sentences come out.
"""

import binascii
import enum
import re
from dataclasses import dataclass
from typing import TypeAlias

PROTOCOL_VERSION = 1
KIND_STATE = 0

# Frames between tiles (section 1).
LINK_BAUD = 38400  # between south and north
ROW_BAUD = 125000  # between east and west
HEADER_SIZE = 4
CRC_SIZE = 2
MAX_CHANNELS = 51
MAX_PAYLOAD = HEADER_SIZE + MAX_CHANNELS + CRC_SIZE
MESSAGE_MAX = 127
MESSAGE_SHIFT = 7  # stored state 2^-13, message 2^-6 (section 4)
STATE_MAX = MESSAGE_MAX << MESSAGE_SHIFT
HIDDEN_MAX = 127
MESSAGE_OFFSET = 128

# Silence (section 2).
SILENT_PERIODS = 4
SILENT_EXTRA_MS = 20

# Telemetry (section 3).
HOST_BAUD = 115200
MAX_SENTENCE = 200
SIDE_LETTERS = "NESW"

# Settings in EEPROM (section 5).
SETTINGS_SIZE = 10
SETTINGS_VERSION = 1
MIN_PERIOD_MS = 10
MAX_PERIOD_MS = 10000


def crc16(data: bytes) -> int:
    """CRC-16/IBM-3740 of `data`; of b"123456789" it is 0x29B1."""
    return binascii.crc_hqx(data, 0xFFFF)


def cobs_encode(payload: bytes) -> bytes:
    """`payload` without any zero byte in it (Cheshire & Baker, 1999); the delimiter is not appended.

    Frames are far shorter than COBS's longest block, so that every block but the last stands for one zero.

    Raises:
        ValueError: the payload has more than MAX_PAYLOAD bytes.
    """
    if len(payload) > MAX_PAYLOAD:
        raise ValueError(f"payload of {len(payload)} bytes; a frame has at most {MAX_PAYLOAD}")
    return b"".join(bytes([len(block) + 1]) + block for block in payload.split(b"\0"))


def cobs_decode(encoded: bytes) -> bytes | None:
    """The payload that `cobs_encode` encoded, or None if no payload of that size does."""
    if not 0 < len(encoded) <= MAX_PAYLOAD + 1 or 0 in encoded:
        return None
    blocks = []
    at = 0
    while at < len(encoded):
        end = at + encoded[at]
        if end > len(encoded):
            return None
        blocks.append(encoded[at + 1 : end])
        at = end
    return b"\0".join(blocks)


@dataclass(frozen=True)
class Frame:
    """The state one tile tells one neighbour.

    Attributes:
        sequence: 0..255, +1 for every frame sent on this side.
        model_id: 0..0xFFFF, of the sender's model.
        messages: one per channel, each -127..127, in units of 2^-6.
    """

    sequence: int
    model_id: int
    messages: tuple[int, ...]


def encode_payload(frame: Frame) -> bytes:
    """The frame's payload with its CRC, as it was before COBS."""
    head = bytes([PROTOCOL_VERSION << 4 | KIND_STATE, frame.sequence]) + frame.model_id.to_bytes(2, "little")
    body = head + bytes(message + MESSAGE_OFFSET for message in frame.messages)
    return body + crc16(body).to_bytes(CRC_SIZE, "little")


def encode_frame(frame: Frame) -> bytes:
    """The frame as it goes on the wire, delimiter included."""
    return cobs_encode(encode_payload(frame)) + b"\0"


def decode_payload(payload: bytes, channels: int) -> Frame | None:
    """The frame in a payload of `channels` messages, or None if it fails any check."""
    body, crc = payload[:-CRC_SIZE], payload[-CRC_SIZE:]
    if len(payload) != HEADER_SIZE + channels + CRC_SIZE or crc16(body) != int.from_bytes(crc, "little"):
        return None
    if body[0] != PROTOCOL_VERSION << 4 | KIND_STATE or 0 in body[HEADER_SIZE:]:
        return None
    messages = tuple(byte - MESSAGE_OFFSET for byte in body[HEADER_SIZE:])
    return Frame(body[1], int.from_bytes(body[2:4], "little"), messages)


class FrameDecoder:
    """Receives one byte at a time and says when a whole, checked frame has arrived.

    Attributes:
        frame: the last good frame; None before the first.
    """

    class Result(enum.Enum):
        """What one byte brought."""

        PENDING = "pending"
        READY = "ready"
        CORRUPT = "corrupt"

    def __init__(self, channels: int) -> None:
        """Expects frames of `channels` messages."""
        self.frame: Frame | None = None
        self._channels = channels
        self._encoded = bytearray()

    def feed(self, byte: int) -> Result:
        """Takes the next byte of the line; `frame` is new whenever the answer is READY."""
        if byte != 0:
            # One byte more than fits is kept, so that a sequence too long never passes for a shorter one.
            if len(self._encoded) <= HEADER_SIZE + self._channels + CRC_SIZE + 1:
                self._encoded.append(byte)
            return self.Result.PENDING
        if not self._encoded:
            return self.Result.PENDING
        payload = cobs_decode(bytes(self._encoded))
        self._encoded.clear()
        frame = None if payload is None else decode_payload(payload, self._channels)
        if frame is None:
            return self.Result.CORRUPT
        self.frame = frame
        return self.Result.READY


@dataclass(frozen=True)
class HelloSentence:
    """What a tile says at boot; `tile` 0 means that no id was set, `updates` 0 for ever."""

    version: int
    tile: int
    model_id: int
    channels: int
    classes: int
    period_ms: int
    updates: int
    reset_cause: int


@dataclass(frozen=True)
class TileSentence:
    """What a tile is and shows; `label` is empty while nothing is shown.

    Attributes:
        links: `NESW` with `-` for every silent side.
        state: the state bytes as sent to the neighbours (message + 128), one per channel.
    """

    tile: int
    uptime_ms: int
    updates: int
    label: str
    links: str
    state: bytes


@dataclass(frozen=True)
class LinkSentence:
    """How one side's link does; `age_ms` of the last good frame is None before the first."""

    tile: int
    uptime_ms: int
    side: str
    sent: int
    received: int
    corrupt: int
    lost: int
    foreign: int
    age_ms: int | None


Sentence: TypeAlias = HelloSentence | TileSentence | LinkSentence


def checksum(body: bytes) -> int:
    """XOR of all bytes between `$` and `*`."""
    result = 0
    for byte in body:
        result ^= byte
    return result


def format_sentence(sentence: Sentence) -> bytes:
    """The sentence as a tile writes it, CR LF included."""
    match sentence:
        case HelloSentence(version, tile, model_id, channels, classes, period_ms, updates, reset_cause):
            about = f"{version},{tile},{model_id:04X},{channels},{classes}"
            text = f"HELLO,{about},{period_ms},{updates},{reset_cause:02X}"
        case TileSentence(tile, uptime_ms, updates, label, links, state):
            text = f"TILE,{tile},{uptime_ms},{updates},{label},{links},{state.hex().upper()}"
        case LinkSentence(tile, uptime_ms, side, sent, received, corrupt, lost, foreign, age_ms):
            age = "" if age_ms is None else age_ms
            text = f"LINK,{tile},{uptime_ms},{side},{sent},{received},{corrupt},{lost},{foreign},{age}"
    body = text.encode("ascii")
    return b"$%s*%02X\r\n" % (body, checksum(body))


_SENTENCE = re.compile(rb"\$([ -#%-)+-~]*)\*([0-9A-F]{2})")
_DECIMAL = r"(\d{1,10})"
_DECIMALS_4, _DECIMALS_5 = ",".join([_DECIMAL] * 4), ",".join([_DECIMAL] * 5)
_HELLO = re.compile(rf"HELLO,{_DECIMAL},{_DECIMAL},([0-9A-F]{{4}}),{_DECIMALS_4},([0-9A-F]{{2}})")
_STATE = rf"((?:[0-9A-F]{{2}}){{1,{MAX_CHANNELS}}})"
_TILE = re.compile(rf"TILE,{_DECIMAL},{_DECIMAL},{_DECIMAL},([!-+\--~]?),([N-][E-][S-][W-]),{_STATE}")
_LINK = re.compile(rf"LINK,{_DECIMAL},{_DECIMAL},([{SIDE_LETTERS}]),{_DECIMALS_5},(\d{{0,10}})")


def parse_sentence(line: bytes | str) -> Sentence | None:
    """The sentence that a line is, or None if it is anything else: noise, damaged, or of an unknown name.

    Never raises, whatever the line holds. White space around the sentence (CR LF) is ignored.
    """
    raw = line.encode("ascii", "replace") if isinstance(line, str) else line
    match = _SENTENCE.fullmatch(raw.strip())
    if match is None or checksum(match[1]) != int(match[2], 16):
        return None
    text = match[1].decode("ascii")
    if hello := _HELLO.fullmatch(text):
        version, tile, model_id, channels, classes, period_ms, updates, cause = hello.groups()
        numbers = int(channels), int(classes), int(period_ms), int(updates)
        return HelloSentence(int(version), int(tile), int(model_id, 16), *numbers, int(cause, 16))
    if report := _TILE.fullmatch(text):
        tile, uptime_ms, updates, label, links, state = report.groups()
        return TileSentence(int(tile), int(uptime_ms), int(updates), label, links, bytes.fromhex(state))
    if link := _LINK.fullmatch(text):
        tile, uptime_ms, side, *counters, age_ms = link.groups()
        sent, received, corrupt, lost, foreign = map(int, counters)
        age = int(age_ms) if age_ms else None
        return LinkSentence(int(tile), int(uptime_ms), side, sent, received, corrupt, lost, foreign, age)
    return None


@dataclass(frozen=True)
class Settings:
    """A tile's settings in EEPROM; `tile_id` 0 means not set, `updates` 0 for ever."""

    tile_id: int
    period_ms: int
    updates: int


def settings_block(tile_id: int, period_ms: int, updates: int) -> bytes:
    """The block of docs/PROTOCOL.md section 5 that a tile reads from EEPROM address 0.

    Raises:
        ValueError: a value is out of range.
    """
    if not (0 <= tile_id <= 255 and MIN_PERIOD_MS <= period_ms <= MAX_PERIOD_MS and 0 <= updates <= 0xFFFF):
        raise ValueError(
            f"tile id {tile_id}, period {period_ms} ms, {updates} updates: must be 0..255, "
            f"{MIN_PERIOD_MS}..{MAX_PERIOD_MS} ms and 0..65535"
        )
    body = b"TN" + bytes([SETTINGS_VERSION, tile_id])
    body += period_ms.to_bytes(2, "little") + updates.to_bytes(2, "little")
    return body + crc16(body).to_bytes(CRC_SIZE, "little")


def parse_settings(block: bytes) -> Settings | None:
    """The settings in a block of SETTINGS_SIZE bytes, or None if a tile would ignore it."""
    body, crc = block[:-CRC_SIZE], block[-CRC_SIZE:]
    if len(block) != SETTINGS_SIZE or body[:3] != b"TN" + bytes([SETTINGS_VERSION]):
        return None
    period_ms = int.from_bytes(body[4:6], "little")
    if crc16(body) != int.from_bytes(crc, "little") or not MIN_PERIOD_MS <= period_ms <= MAX_PERIOD_MS:
        return None
    return Settings(body[3], period_ms, int.from_bytes(body[6:8], "little"))
