"""Frames between tiles, twin of the firmware's core/frame: bytes go in, frames come out."""

import enum
from dataclasses import dataclass

from tilenca.protocol.checksums import crc16
from tilenca.protocol.constants import (
    CRC_SIZE,
    HEADER_SIZE,
    KIND_STATE,
    MAX_PAYLOAD,
    MESSAGE_OFFSET,
    PROTOCOL_VERSION,
)


def cobs_encode(payload: bytes) -> bytes:
    """`payload` encoded without zero bytes (Cheshire & Baker, 1999); the delimiter is not appended.

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
    """The state that one tile sends to one neighbour.

    Attributes:
        side: of the sender, where it leaves: 0 N, 1 E, 2 S, 3 W.
        tile: the sender's id; 0 if it has none.
        sequence: 0..255, +1 for every frame sent on this side.
        model_id: 0..0xFFFF, of the sender's model.
        messages: one per channel, each -127..127, in units of 2^-6.
    """

    side: int
    tile: int
    sequence: int
    model_id: int
    messages: tuple[int, ...]


def encode_payload(frame: Frame) -> bytes:
    """The frame's payload with its CRC, as it was before COBS."""
    first = PROTOCOL_VERSION << 4 | KIND_STATE << 2 | frame.side
    body = bytes([first, frame.tile, frame.sequence]) + frame.model_id.to_bytes(2, "little")
    body += bytes(message + MESSAGE_OFFSET for message in frame.messages)
    return body + crc16(body).to_bytes(CRC_SIZE, "little")


def encode_frame(frame: Frame) -> bytes:
    """The frame's bytes on the wire, delimiter included."""
    return cobs_encode(encode_payload(frame)) + b"\0"


def decode_payload(payload: bytes, channels: int) -> Frame | None:
    """The frame in a payload of `channels` messages, or None if it fails any check."""
    body, crc = payload[:-CRC_SIZE], payload[-CRC_SIZE:]
    if len(payload) != HEADER_SIZE + channels + CRC_SIZE or crc16(body) != int.from_bytes(crc, "little"):
        return None
    if body[0] >> 2 != PROTOCOL_VERSION << 2 | KIND_STATE or 0 in body[HEADER_SIZE:]:
        return None
    messages = tuple(byte - MESSAGE_OFFSET for byte in body[HEADER_SIZE:])
    return Frame(body[0] & 3, body[1], body[2], int.from_bytes(body[3:5], "little"), messages)


class FrameDecoder:
    """Receives one byte at a time and says when a whole, checked frame has arrived.

    Attributes:
        frame: the last good frame; None before the first.
    """

    class Result(enum.Enum):
        """The result of one byte."""

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
