"""Bytes from a tile in, sentences and damaged lines out. Owns no port and no clock."""

import re
from dataclasses import dataclass

from tilenca.protocol.board_test import board_test_text
from tilenca.protocol.constants import MAX_SENTENCE
from tilenca.protocol.sentences import Sentence, parse_sentence

# A sentence begins at `$` and ends with two digits after `*`; its checksum decides whether it is one.
_CANDIDATE = re.compile(rb"\$[^*]*\*..", re.DOTALL)
_BREAK = re.compile(rb"[\r\n]+|(?=\$)")


class LineReader:
    """Cuts a stream of bytes into sentences and the damaged rest.

    Nothing is lost silently: a byte that is neither white space nor part of a good sentence is in a damaged
    line, except the tail of a line whose beginning was missed.
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
        time_s: its time, in seconds since 1970.
        port: its port.
        raw: the line's bytes, without its end.
        sentence: its sentence; None if it is damaged, or the board test's.
    """

    time_s: float
    port: str
    raw: bytes
    sentence: Sentence | None

    @property
    def board_test(self) -> str | None:
        """The board test's text in this line; None if the line is another program's."""
        return board_test_text(self.raw)
