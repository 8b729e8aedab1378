"""Talking to the firmware on an emulated tile as a host does on USB."""

from typing import TypeVar

from tilenca.emulator import Array
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import AckSentence, HelloSentence, NakSentence, Sentence

STEP_S = 0.01
Kind = TypeVar("Kind")
ANSWERS = (AckSentence, NakSentence, HelloSentence)


class Talk:
    """What was said by one tile of an array that this runs."""

    def __init__(self, array: Array, index: int = 0) -> None:
        self.array, self.tile = array, array[index]
        self.said: list[Sentence] = []
        self.damaged: list[bytes] = []
        self._reader = LineReader()

    def listen(self, seconds: float) -> list[Sentence]:
        """Runs so long and returns the sentences that came in it."""
        self.array.run(seconds)
        heard = self._reader.feed(self.tile.read_serial())
        new = [sentence for _, sentence in heard if sentence is not None]
        self.damaged += [raw for raw, sentence in heard if sentence is None]
        self.said += new
        return new

    def ask(self, command: bytes, patience_s: float = 0.5) -> Sentence:
        """Says something and runs until it is answered."""
        self.tile.write_serial(command)
        for _ in range(int(patience_s / STEP_S)):
            for sentence in self.listen(STEP_S):
                if isinstance(sentence, ANSWERS):
                    return sentence
        raise AssertionError(f"no answer to {command!r} in {patience_s} s")

    def last(self, kind: type[Kind]) -> Kind:
        """The last sentence of a kind."""
        return [sentence for sentence in self.said if isinstance(sentence, kind)][-1]
