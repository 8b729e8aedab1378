"""The lines that emulated tiles say on USB, each with its time."""

import re

from tilenca.emulator.tile import EmulatedTile
from tilenca.emulator.types import port_name
from tilenca.protocol.line_reader import Heard, LineReader

# Bytes after which a line may be complete: its end, or the beginning of the next one.
_PIECE = re.compile(rb"[^\r\n$]*[\r\n$]|[^\r\n$]+")


def heard_from(tile: EmulatedTile, reader: LineReader) -> list[Heard]:
    """The tile's lines since the last call; each has the time of the byte that completed it.

    Args:
        tile: whose port is called `tile-01`, ...
        reader: of this tile only; it keeps the beginning of a line that is not complete.
    """
    timed = tile.read_serial_timed()
    heard = []
    for piece in _PIECE.finditer(bytes(value for _, value in timed)):
        for raw, sentence in reader.feed(piece[0]):
            heard.append(Heard(timed[piece.end() - 1][0], port_name(tile.index), raw, sentence))
    return heard
