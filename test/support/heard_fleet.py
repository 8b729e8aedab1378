"""A fleet of which a test says what its tiles say."""

from tilenca.fleet.events import Reporter
from tilenca.fleet.state import Event, Fleet, PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    LinkSentence,
    Sentence,
    TileSentence,
)

# Ten classes in the last ten channels; the fifth is the greatest.
STATE = bytes([128] * 15 + [200] + [100] * 5)
FACING = dict(zip("NESW", "SWNE", strict=True))


def link(
    tile: int, side: str, other: int | None, uptime_ms: int = 0, received: int = 0, lost: int = 0
) -> LinkSentence:
    facing = None if other is None else FACING[side]
    return LinkSentence(tile, uptime_ms, side, 0, received, 0, lost, 0, 9, 0, other, facing)


class HeardFleet:
    """A fleet that is told what tiles say, and the news of it."""

    def __init__(self) -> None:
        self.fleet = Fleet()
        self.reporter = Reporter(self.fleet)
        self.news: list[str] = []

    def take(self, event: Event) -> None:
        self.fleet.take(event)
        self.news += [news.text for news in self.reporter.take(event)]

    def open(self, *ports: str) -> None:
        for port in ports:
            self.take(PortNews(0.0, port, is_open=True))

    def say(self, port: str, *sentences: Sentence, time_s: float = 1.0) -> None:
        for sentence in sentences:
            self.take(Heard(time_s, port, b"", sentence))


def three_in_an_l() -> HeardFleet:
    lab = HeardFleet()
    lab.open("a", "b", "c")
    lab.say("a", TileSentence(1, 100, 7, "4", 4, 30, "-ES-", STATE), link(1, "E", 2), link(1, "S", 3))
    lab.say("b", TileSentence(2, 100, 8, "4", 4, 30, "---W", STATE), link(2, "W", 1))
    lab.say("c", TileSentence(3, 100, 9, "9", 9, 30, "N---", STATE), link(3, "N", 1))
    return lab
