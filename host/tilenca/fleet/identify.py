"""Asks many tiles at once for their ids and firmware."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

from tilenca.fleet.link_health import LinkHealth
from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Event, PortNews
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.commands import ask_command, chip_command
from tilenca.protocol.sentences import (
    BoardSentence,
    ChipSentence,
    HelloSentence,
    LinkSentence,
    OtherVersionSentence,
)

# After a reset a tile greets by itself as soon as its bootloader stops waiting. Until then the bootloader
# takes any byte for the beginning of a command and waits for more. So a question goes only to a tile that has
# spoken (a running tile does every second) or has had the time to.
BOOT_S = 3.0
# Bytes right after opening may be from before the reset.
STALE_S = 0.3
# The time between two questions, and the time after which a silent tile is given up.
AGAIN_S = 1.0
PATIENCE_S = 7.0
TICK_S = 0.05
# A tile tells what it measures every second; one of an older firmware never does. Two reports say what is
# wrong now: counters since its start hide a fault that began late, and remember one that is over.
BOARD_S = 2.3

SILENT = "says nothing"


@dataclass(frozen=True)
class Answer:
    """A tile's greeting, or the `problem` that prevented one.

    Attributes:
        board: what it measures, if awaited, and `board_before` a second earlier.
        chip: its fuses and its board's marking, if awaited.
        health: of each side's link meanwhile, by letter.
    """

    hello: HelloSentence | None = None
    problem: str = ""
    board: BoardSentence | None = None
    chip: ChipSentence | None = None
    board_before: BoardSentence | None = None
    health: dict[str, LinkHealth] = field(default_factory=dict)

    @property
    def firmware_id(self) -> int | None:
        """CRC-32 of its flash; None if it does not report one."""
        return self.hello.firmware_id if self.hello else None


class _Asked:
    """The questions to one tile: `ask_s` is the time of the next one, `end_s` the time to give up."""

    def __init__(self, patience_s: float, board_s: float) -> None:
        self.answer: Answer | None = None
        self.wait_s = 0.0  # until then, more may come after the answer
        self.asks_chip = False  # it has greeted, and its chip is still to be asked for
        self._board_s = board_s
        self.ask_s = self.end_s = float("inf")
        self._fresh_s = 0.0  # earlier bytes may be from before a reset
        self._is_asked = False
        self._patience_s = patience_s

    def begin(self, now_s: float, ask_s: float) -> None:
        """The port is open."""
        self._fresh_s, self.ask_s, self.end_s = now_s + STALE_S, ask_s, now_s + self._patience_s

    def asked(self, now_s: float) -> None:
        """The question was sent."""
        self.ask_s = now_s + AGAIN_S
        self._is_asked = True

    def take(self, event: Event, now_s: float) -> None:
        """Adds an event of its port."""
        if isinstance(event, PortNews):
            if event.is_open:
                self.begin(now_s, now_s + BOOT_S)
            else:
                self.answer = Answer(problem=event.reason.removesuffix("; waiting for it"))
        elif isinstance(event.sentence, HelloSentence):
            if self.answer is None:
                self.answer = Answer(event.sentence)
                self.wait_s = now_s + self._board_s
                self.asks_chip = self._board_s > 0
        elif isinstance(event.sentence, BoardSentence) and self.answer and self.answer.hello:
            before = self.answer.board
            self.answer = replace(self.answer, board=event.sentence, board_before=before)
            self.wait_s = now_s if before else self.wait_s
        elif isinstance(event.sentence, LinkSentence) and self.answer:
            self.answer.health.setdefault(event.sentence.side, LinkHealth()).take(event.sentence)
        elif isinstance(event.sentence, ChipSentence) and self.answer:
            self.answer = replace(self.answer, chip=event.sentence)
        elif isinstance(event.sentence, OtherVersionSentence):
            self.answer = Answer(problem=f"speaks protocol {event.sentence.version}")
        elif now_s < self._fresh_s:
            return
        elif event.board_test:
            self.answer = Answer(problem=BOARD_TEST)
        elif event.sentence is not None and not self._is_asked:
            self.ask_s = min(self.ask_s, now_s)


def ask_all(
    names: Sequence[str],
    user: str,
    report: Callable[[str, Answer], None] = lambda name, answer: None,
    patience_s: float = PATIENCE_S,
    clock: Callable[[], float] = time.monotonic,
    board_s: float = 0.0,
) -> dict[str, Answer]:
    """Asks the tiles behind the ports; opening a port may reset its tile.

    Args:
        names: the ports.
        user: the command that asks, to be named to others that want a port meanwhile.
        report: called with each answer as it comes.
        patience_s: how long a tile may say nothing.
        clock: seconds that only grow.
        board_s: how long to wait, after its greeting, for what a tile measures on its board, and its fuses.

    Returns:
        An answer for each port, in the order of `names`.
    """
    with PortReader(names, clock=clock, user=user) as reader:
        return ask(reader, names, report, patience_s=patience_s, clock=clock, board_s=board_s)


def ask(
    reader: PortReader,
    names: Iterable[str],
    report: Callable[[str, Answer], None] = lambda name, answer: None,
    hear: Callable[[Event], None] = lambda event: None,
    patience_s: float = PATIENCE_S,
    clock: Callable[[], float] = time.monotonic,
    board_s: float = 0.0,
) -> dict[str, Answer]:
    """As `ask_all`, with ports that stay open; `hear` gets every event meanwhile."""
    asked = {name: _Asked(patience_s, board_s) for name in names}
    for name in asked.keys() & set(reader.open):
        asked[name].begin(clock(), clock())
    waiting = set(asked)
    while waiting:
        for event in reader.poll(TICK_S):
            hear(event)
            if event.port in waiting:
                asked[event.port].take(event, clock())
        now_s = clock()
        for name in sorted(waiting):
            tile = asked[name]
            if tile.answer is None and now_s >= tile.end_s:
                tile.answer = Answer(problem=SILENT)
            if tile.asks_chip:
                tile.asks_chip = False
                reader.write(name, chip_command())
            if tile.answer is not None and now_s < tile.wait_s:
                continue
            if tile.answer is not None:
                waiting.discard(name)
                report(name, tile.answer)
            elif now_s >= tile.ask_s:
                tile.asked(now_s)
                reader.write(name, ask_command())
    return {name: tile.answer or Answer(problem=SILENT) for name, tile in asked.items()}
