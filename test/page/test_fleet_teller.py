"""What the page is told of real tiles: the places, what they show, how they are, and what has changed."""

from typing import Any

from support.heard_fleet import STATE, link
from tilenca.fleet.grid import Grid
from tilenca.fleet.state import PortNews
from tilenca.fleet.tiles_file import Place
from tilenca.page.fleet_teller import ANSWER_S, NO_PORT, FleetTeller
from tilenca.protocol.constants import PROTOCOL_VERSION
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import ErrorSentence, HelloSentence, Sentence, TileSentence, format_sentence
from tilenca.protocol.stream import KINDS, StreamEvent
from tilenca.shapes.glyphs import look_of

BEGAN_S = 1_000_000.0
HEX_MODEL = 0xBEEF


def labels_of(model_id: int) -> tuple[str, ...] | None:
    return tuple("0123456789AbCdEF-") if model_id == HEX_MODEL else None


class Lab:
    """A teller, and tiles that speak to it."""

    def __init__(self, places: list[Place] | None = None) -> None:
        self.teller = FleetTeller(Grid(places or []), tuple("0123456789"), labels_of, BEGAN_S)
        self.time_s = BEGAN_S

    def open(self, *ports: str) -> list[StreamEvent]:
        return [event for port in ports for event in self.teller.take(PortNews(self.time_s, port, True, ""))]

    def say(self, port: str, *sentences: Sentence) -> list[StreamEvent]:
        self.time_s += 0.5
        told = []
        for one in sentences:
            raw = format_sentence(one).strip()
            told += self.teller.take(Heard(self.time_s, port, raw, one))
        return told

    def look(self) -> list[StreamEvent]:
        return self.teller.look(self.time_s)


def two() -> Lab:
    lab = Lab()
    lab.open("/dev/a", "/dev/b")
    lab.say("/dev/a", TileSentence(1, 100, 7, "4", 4, 30, "-E--", STATE), link(1, "E", 2))
    lab.say("/dev/b", TileSentence(2, 100, 8, "9", 9, 30, "---W", STATE), link(2, "W", 1))
    return lab


def hello(model_id: int, tile: int = 1) -> HelloSentence:
    return HelloSentence(PROTOCOL_VERSION, tile, model_id, 21, 11, 20, 0, 1, 0, 255)


def of(events: list[StreamEvent], kind: str, port: str = "") -> list[Any]:
    return [event[kind] for event in events if kind in event and port in ("", event.get("port"))]


def test_tiles_lie_and_look_as_they_say_and_that_is_told_once() -> None:
    lab = two()
    events = lab.look()
    assert [sum(kind in event for kind in KINDS) for event in events] == [1] * len(events)
    places = {event["port"]: (event["place"], event["tile"]) for event in events if "place" in event}
    assert places == {"/dev/a": ([0, 0], 1), "/dev/b": ([0, 1], 2)}
    [display] = of(events, "display", "/dev/b")
    look = look_of("9", 9)
    assert display == {"segments": look.segments, "rgb": list(look.colour), "leds": "---W"}
    [health] = of(events, "health", "/dev/a")
    assert health == {"trouble": "", "links": {"E": ["well", None]}}
    assert {event["time"] for event in events} == {1.0}
    assert lab.look() == []


def test_a_port_that_goes_away_is_told_with_its_reason_and_comes_back() -> None:
    lab = two()
    lab.look()
    told = lab.teller.take(PortNews(lab.time_s + 1, "/dev/b", False, "went away"))
    assert (of(told, "open"), told[0]["reason"]) == ([False], "went away")
    assert of(told, "note") == ["port went away"]
    events = lab.look()
    assert of(events, "health", "/dev/b")[0]["trouble"] == "away"
    assert of(events, "display", "/dev/b")[0]["segments"] == 0
    lab.open("/dev/b")
    events = lab.look()
    assert of(events, "health", "/dev/b")[0]["trouble"] == ""
    assert of(events, "display", "/dev/b")[0]["segments"] == look_of("9", 9).segments


def test_a_tile_that_says_nothing_for_long_is_silent() -> None:
    lab = two()
    lab.look()
    lab.time_s += 60
    assert {health["trouble"] for health in of(lab.look(), "health")} == {"silent"}


def test_a_tile_of_the_file_that_is_not_there_has_its_place() -> None:
    lab = Lab([Place(1, "port:/dev/a", 0, 0), Place(7, "serial:x", 0, 1)])
    lab.open("/dev/a")
    lab.say("/dev/a", TileSentence(1, 100, 7, "4", 4, 30, "----", STATE))
    events = lab.look()
    absent = [event for event in events if event.get("port") == "(tile 7)"]
    assert [absent[0]["place"], absent[0]["tile"]] == [[0, 1], 7]
    assert (absent[1]["open"], absent[1]["reason"]) == (False, NO_PORT)


def test_a_board_that_comes_back_at_another_port_is_told_there_and_no_more_here() -> None:
    lab = two()
    lab.look()
    lab.teller.take(PortNews(lab.time_s, "/dev/b", False, "went away"))
    lab.open("/dev/c")
    lab.say("/dev/c", TileSentence(2, 100, 1, "9", 9, 30, "---W", STATE), link(2, "W", 1))
    places = {event["port"]: event["place"] for event in lab.look() if "place" in event}
    assert places == {"/dev/b": None, "/dev/c": [0, 1]}


def test_another_model_and_a_label_of_none_bring_the_classes_anew() -> None:
    lab = two()
    [classes] = of(lab.say("/dev/a", hello(HEX_MODEL)), "classes")
    assert "".join(look["label"] for look in classes) == "0123456789AbCdEF-"
    assert of(lab.say("/dev/b", hello(HEX_MODEL, 2)), "classes") == []
    [classes] = of(lab.say("/dev/b", TileSentence(2, 1, 1, "H", 3, 30, "---W", STATE)), "classes")
    assert classes[-1]["label"] == "H"


def test_a_hello_that_was_asked_for_is_no_start() -> None:
    lab = two()
    lab.look()
    lab.say("/dev/a", ErrorSentence(1, 200, "FAULT", "of the past"))
    lab.teller.asked("/dev/a", lab.time_s)
    events = lab.say("/dev/a", hello(0x1234))
    [told] = [event for event in events if "raw" in event]
    assert told["asked"]
    assert of(events, "note") == []
    view = lab.teller.fleet.tiles["/dev/a"]
    assert (view.hello, view.error) == (hello(0x1234), ErrorSentence(1, 200, "FAULT", "of the past"))
    again = lab.say("/dev/a", TileSentence(1, 200, 9, "4", 4, 30, "-E--", STATE))
    assert of(again, "note") == [], "it has shown that before"
    assert of(lab.look(), "display") == [], "it goes on showing what it did"
    [told] = [event for event in lab.say("/dev/a", hello(0x1234)) if "raw" in event]
    assert "asked" not in told
    assert of(lab.look(), "display", "/dev/a")[0]["segments"] == 0, "it has started"


def test_who_comes_later_hears_last_that_a_port_is_closed() -> None:
    lab = two()
    lab.teller.take(PortNews(lab.time_s, "/dev/b", False, "went away"))
    about = [event for event in lab.teller.all(lab.time_s) if event.get("port") == "/dev/b"]
    kinds = [kind for event in about for kind in ("raw", "open") if kind in event]
    assert kinds == ["raw", "raw", "open"], "what it has said before does not hold any more"


def test_a_hello_long_after_it_was_asked_for_is_a_start() -> None:
    lab = two()
    lab.teller.asked("/dev/a", lab.time_s)
    lab.time_s += ANSWER_S
    events = lab.say("/dev/a", hello(0x1234))
    [told] = [event for event in events if "raw" in event]
    assert "asked" not in told
    assert any(note.startswith("started: ") for note in of(events, "note"))


def test_who_comes_later_is_told_everything_and_news_goes_on() -> None:
    lab = two()
    lab.look()
    lab.say("/dev/a", TileSentence(1, 200, 9, "7", 7, 30, "-E--", STATE))
    everything = lab.teller.all(lab.time_s)
    assert of(everything, "open") == [True, True]
    lines = [event["raw"] for event in everything if event.get("port") == "/dev/a" and "raw" in event]
    assert [line.split(",")[0] for line in lines] == ["$LINK", "$TILE"]
    assert ",7,7," in lines[-1]
    assert of(everything, "display", "/dev/a")[0]["segments"] == look_of("7", 7).segments
    assert "shows 7, before 4" in of(everything, "note")
    [display] = of(lab.look(), "display", "/dev/a")
    assert display["segments"] == look_of("7", 7).segments, "it is still news for the others"
    assert lab.look() == []
