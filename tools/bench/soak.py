"""Counts the frames of twenty emulated tiles with all their neighbours, as fast as they go.

Neighbours' clocks are a whole percent apart, phases are random, every tile computes and talks on USB.
"""

import random
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from firmware import cost_fit
from tilenca.base.sides import NORTH, SIDES, SOUTH
from tilenca.emulator import Array
from tilenca.emulator.wiring import cables
from tilenca.model.file import Dimensions, Model
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import HelloSentence, LinkSentence, Sentence
from tilenca.protocol.settings import settings_block
from tilenca.shapes.file import Shape

BLOCK = Shape("B", ("####",) * 5, "B")
# Narrow enough to update every 10 ms without any zeros; the frames are as long as the digits'.
SMALL = Dimensions(21, 40, 40)
PERIOD_MS = 10
PPM_APART = 10_000.0
SWITCH_ON_S = 0.2
# A tile that is switched on in the middle of its neighbour's frame receives only its end. So counts are
# compared with the first sentence of a side after the start.
SETTLED_MS = 1000
SLICE_S = 0.5


@dataclass(frozen=True)
class Frames:
    """The counts of one or more sides.

    Attributes:
        sent: frames.
        received: good ones.
        corrupt: damaged ones.
        lost: gaps in the sequence numbers.
    """

    sent: int = 0
    received: int = 0
    corrupt: int = 0
    lost: int = 0

    def __add__(self, other: "Frames") -> "Frames":
        return Frames(*(getattr(self, name) + getattr(other, name) for name in COUNTERS))

    def __sub__(self, other: "Frames") -> "Frames":
        return Frames(*(getattr(self, name) - getattr(other, name) for name in COUNTERS))

    @property
    def damaged(self) -> int:
        """Frames that did not arrive whole; each counts as corrupt, as lost, or as both."""
        return max(self.corrupt, self.lost)


COUNTERS = ("sent", "received", "corrupt", "lost")


class Ledger:
    """Reads the tiles' sentences, and counts their links' frames and their restarts.

    Attributes:
        hellos: how often each tile, counted from 0, greeted at a start.
    """

    def __init__(self, array: Array) -> None:
        self.hellos = [0] * len(array)
        self._array = array
        self._readers = [LineReader() for _ in array]
        self._first: dict[tuple[int, int], LinkSentence] = {}
        self._last: dict[tuple[int, int], LinkSentence] = {}

    def listen(self) -> Iterator[tuple[int, Sentence]]:
        """The sentences since the last call, each with its tile, counted from 0."""
        for tile in self._array:
            for _, sentence in self._readers[tile.index].feed(tile.read_serial()):
                if sentence is None:
                    continue
                self.hellos[tile.index] += isinstance(sentence, HelloSentence)
                if isinstance(sentence, LinkSentence):
                    end = tile.index, SIDES.index(sentence.side)
                    self._last[end] = sentence
                    if sentence.uptime_ms >= SETTLED_MS:
                        self._first.setdefault(end, sentence)
                yield tile.index, sentence

    def frames(self, tile: int, side: int) -> Frames:
        """The counts of a side between its first and its last sentence after the start.

        Raises:
            KeyError: it has sent no sentence since then.
        """
        first, last = self._first[tile, side], self._last[tile, side]
        return Frames(*(getattr(last, name) - getattr(first, name) for name in COUNTERS))

    def total(self, ends: Iterable[tuple[int, int]]) -> Frames:
        """The same of several sides."""
        return sum((self.frames(*end) for end in ends), Frames())


@dataclass(frozen=True)
class Soaked:
    """The result.

    Attributes:
        seconds: of emulated time.
        hardware: frames on the sides with a USART whose neighbour has one too.
        to_software: frames from a USART to a south side.
        from_software: frames from a south side to a USART.
        restarts: of all tiles.
        awake: share of the time, of the busiest tile.
    """

    seconds: float
    hardware: Frames
    to_software: Frames
    from_software: Frames
    restarts: int
    awake: float

    @property
    def all(self) -> Frames:
        """All frames."""
        return self.hardware + self.to_software + self.from_software


def small_model() -> Model:
    """A network that keeps a tile busy for most of PERIOD_MS."""
    return cost_fit.Probe.of(SMALL, half=False).model()


def checkerboard(shape: Shape, apart_ppm: float) -> list[float]:
    """Clock errors that differ by exactly this much between every two neighbours."""
    return [apart_ppm / 2 * (-1) ** (row + column) for row, column in shape.cells]


def soak(
    elf: Path, period_ms: int, seconds: float, seed: int = 0, on_slice: Callable[[float], None] | None = None
) -> Soaked:
    """Runs the block of tiles.

    Args:
        elf: the firmware.
        period_ms: from update to update.
        seconds: of emulated time.
        seed: of the phases.
        on_slice: called at intervals with the seconds done.

    Raises:
        TilencaError: the image cannot be run, or a tile stopped.
    """
    draw = random.Random(seed)
    links = cables(BLOCK)
    start_s = [draw.uniform(0, SWITCH_ON_S) for _ in BLOCK.cells]
    with Array(elf, len(BLOCK.cells), links, checkerboard(BLOCK, PPM_APART), start_s) as array:
        for tile in array:
            tile.write_eeprom(0, settings_block(tile.index + 1, period_ms, 0))
        ledger = Ledger(array)
        while array.time_s < seconds:
            array.run(SLICE_S)
            for _ in ledger.listen():
                pass
            if on_slice is not None:
                on_slice(array.time_s)
        ends = [(tile, side) for tile, side, _, _ in links] + [(tile, side) for _, _, tile, side in links]
        return Soaked(
            array.time_s,
            ledger.total(end for end in ends if end[1] not in (NORTH, SOUTH)),
            ledger.total(end for end in ends if end[1] == SOUTH),
            ledger.total(end for end in ends if end[1] == NORTH),
            sum(ledger.hellos) - len(array),
            max(1 - tile.sleep_share for tile in array),
        )
