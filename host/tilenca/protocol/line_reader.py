"""Bytes from a tile in, sentences and damaged lines out. Owns no port and no clock."""

import re
from dataclasses import dataclass

from tilenca.protocol.board_test import board_test_text
from tilenca.protocol.constants import MAX_SENTENCE
from tilenca.protocol.patterns import SENTENCE
from tilenca.protocol.sentences import Sentence, sentence_of

# A line, and what completes it: its end, or the `$` of the next one. The last one may be without.
_LINE = re.compile(rb"(\$?[^\r\n$]*)(?:[\r\n]+|(?=\$)|\Z)")


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
        return [line for _, line in self.feed_at(data)]

    def feed_at(self, data: bytes) -> list[tuple[int, tuple[bytes, Sentence | None]]]:
        """Like `feed`, each line with the index in `data` of the byte that completed it."""
        before, text = len(self._buffer), self._buffer + data
        self._buffer = b""
        lines = []
        for match in _LINE.finditer(text):
            end = match.end(1)
            if end == len(text):
                if len(match[1]) <= MAX_SENTENCE:
                    self._buffer = match[1]
                    break
                end -= 1
            if piece := match[1].strip():
                if not self._joined_midway or piece.startswith(b"$") or board_test_text(piece):
                    lines += [(end - before, line) for line in _lines(piece)]
                self._joined_midway = False
        return lines


def _lines(piece: bytes) -> list[tuple[bytes, Sentence | None]]:
    """The sentence that a piece begins with, and the rest; its checksum decides whether it is one."""
    match = SENTENCE.match(piece)
    sentence = sentence_of(match) if match else None
    if match is None or sentence is None:
        return [(piece, None)]
    rest = piece[match.end() :].strip()
    return [(match[0], sentence), *([(rest, None)] if rest else [])]


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
