"""The log tells what is new, once."""

from dataclasses import replace

from support.heard_fleet import STATE, HeardFleet
from support.scripted_port import HELLO
from tilenca.fleet.events import REMEDY, News, Reporter, clock_text, news_line
from tilenca.fleet.state import Event, Fleet, PortNews
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    AckSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
)

PORT = "/dev/ttyACM0"
TILE = TileSentence(7, 1000, 10, "4", 4, 30, "N---", bytes([128] * 21))
LINK = LinkSentence(7, 1000, "N", 100, 100, 0, 0, 0, 5, 0, 8, "S")


class Log:
    """The lines of a log that is told sentences of one tile."""

    def __init__(self) -> None:
        self._fleet = Fleet()
        self._reporter = Reporter(self._fleet)
        self.take(PortNews(0.0, PORT, is_open=True))

    def take(self, event: Event) -> list[tuple[str, bool]]:
        self._fleet.take(event)
        return [(news.text, news.bad) for news in self._reporter.take(event)]

    def hear(self, sentence: Sentence) -> list[tuple[str, bool]]:
        return self.take(Heard(1.0, PORT, b"", sentence))


def test_a_label_is_told_when_it_changes() -> None:
    log = Log()
    assert log.hear(TILE) == [("shows 4", False)]
    assert log.hear(replace(TILE, updates=11)) == []
    assert log.hear(replace(TILE, label="1", class_index=1)) == [("shows 1, before 4", False)]
    assert log.hear(replace(TILE, label="", class_index=None, margin=None)) == [
        ("shows nothing, before 1", False)
    ]
    [(started, bad)] = log.hear(HELLO)
    assert started.startswith("started: protocol 3")
    assert not bad
    assert log.hear(TILE)[0] == ("shows 4", False), "it has begun again"


def test_neighbours_that_come_and_go_are_told() -> None:
    log = Log()
    assert len(log.hear(TILE)) == 1, "those of the first sentence are no news"
    assert log.hear(replace(TILE, links="N-S-")) == [("hears a neighbour on S", False)]
    assert log.hear(replace(TILE, links="-E-W")) == [
        ("lost its neighbour on N S", True),
        ("hears a neighbour on E W", False),
    ]


def test_a_failing_link_is_told_once_and_again_when_it_is_well() -> None:
    log = Log()
    log.hear(LINK)
    failing = replace(LINK, uptime_ms=2000, received=150, lost=50)
    assert log.hear(failing) == [("link N is failing: 50% of the frames get lost", True)]
    assert log.hear(replace(failing, uptime_ms=2100)) == []
    better = replace(failing, uptime_ms=20_000, received=150 + 950, lost=50 + 50)
    assert log.hear(better) == [], "95 % is not well yet"
    well = replace(better, uptime_ms=40_000, received=better.received + 1000)
    assert log.hear(well) == [("link N is well again", False)]


def test_a_tile_with_another_model_is_told_with_the_remedy() -> None:
    log = Log()
    log.hear(LINK)
    foreign = replace(LINK, uptime_ms=2000, foreign=3)
    assert log.hear(foreign) == [(f"a tile with another model is on N: {REMEDY}", True)]
    assert log.hear(replace(foreign, uptime_ms=3000, foreign=4)) == []
    assert log.hear(replace(foreign, uptime_ms=20_000, foreign=4)) == [
        ("no other model is on N any more", False)
    ]


def test_complaints_are_bad_and_answers_are_not() -> None:
    log = Log()
    assert log.hear(ErrorSentence(7, 0, "STACK", "is full")) == [("STACK is full", True)]
    assert log.hear(NakSentence(7, "CHECKSUM")) == [("sentence: damaged", True)]
    assert log.hear(AckSentence(7, "SET", ("period", "20"))) == [("SET period 20", False)]
    assert log.take(Heard(1.0, PORT, b"$x", None)) == [("damaged: $x", True)]
    assert log.take(PortNews(2.0, PORT, is_open=False, reason="went away")) == [("port went away", True)]


def test_a_line_names_time_tile_and_port() -> None:
    news = News(0.0005, PORT, 7, "shows 4")
    assert news_line(news).endswith(f".000 tile   7 {PORT} shows 4")
    assert news_line(News(0.0, PORT, None, "port open"), "ttyACM0").endswith(" tile   - ttyACM0 port open")


def test_milliseconds_are_rounded_with_their_second() -> None:
    assert clock_text(59.9996).endswith(":00.000")
    assert clock_text(59.9994).endswith(":59.999")


def test_the_log_tells_what_changed_and_nothing_twice() -> None:
    lab = HeardFleet()
    lab.open("a")
    for label in ("4", "4", "9", "9"):
        lab.say("a", TileSentence(1, 100, 1, label, int(label), 30, "----", STATE))
    lab.say("a", HelloSentence(3, 1, 0, 21, 10, 20, 0, 8, 0xABCD, 255))
    lab.take(Heard(1.0, "a", b"\x1bnoise", None))
    heads = [text.split(":")[0] for text in lab.news]
    assert heads == ["port open", "shows 4", "shows 9, before 4", "started", "damaged"]
    assert "watchdog" in lab.news[3]


def test_a_tile_of_another_version_is_told_once_until_it_starts_again_as_ours() -> None:
    lab = HeardFleet()
    lab.open("a")
    lab.say("a", *[OtherVersionSentence(2, 1)] * 3)
    assert [text for text in lab.news if "protocol 2" in text] == [OtherVersionSentence(2, 1).remedy]
    lab.say("a", HelloSentence(3, 1, 0, 21, 10, 20, 0, 8, 0xABCD, 255), OtherVersionSentence(2, 1))
    assert len([text for text in lab.news if "these tools speak" in text]) == 2
