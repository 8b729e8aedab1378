"""The fleet as a table, and events as lines of a log."""

from support.tile_port import STATE
from tilenca.fleet.state import PortNews, TileView
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
    TimeSentence,
)
from tilenca.views.fleet_table import cells, log_line


def test_a_log_line_names_time_port_and_tile() -> None:
    sentences: dict[str, Sentence] = {
        "tile 7 TILE shows nothing update 0 up 0.5 s links ----": TileSentence(
            7, 500, 0, "", None, None, "----", STATE
        ),
        "tile 7 LINK W sent 1 received 2 corrupt 3 lost 4 foreign 5 overruns 6 age never": LinkSentence(
            7, 0, "W", 1, 2, 3, 4, 5, None, 6, None, None
        ),
        "tile 7 LINK W sent 1 received 2 corrupt 3 lost 4 foreign 5 overruns 6 age 12 ms from tile 9 E": (
            LinkSentence(7, 0, "W", 1, 2, 3, 4, 5, 12, 6, 9, "E")
        ),
        "tile 7 HELLO protocol 3 firmware 00C0FFEE model 00AB (21 channels, 10 classes) every 250 ms "
        "for ever brightness 128 reset by power-on and watchdog": (
            HelloSentence(3, 7, 0xAB, 21, 10, 250, 0, 9, 0xC0FFEE, 128)
        ),
        "tile 7 TIME computes 14200 us awake 16.3 % longest turn 2048 us stack 5000 bytes unused "
        "3 sentences dropped": TimeSentence(7, 0, 14200, 163, 2048, 5000, 3),
        "tile 7 ERROR SETTINGS defaults in force": ErrorSentence(7, 0, "SETTINGS", "defaults in force"),
        "tile 7 ACK SET period 20": AckSentence(7, "SET", ("period", "20")),
        "tile 7 NAK SET: wrong field": NakSentence(7, "VALUE", "SET"),
        "tile 7 NAK sentence: damaged": NakSentence(7, "CHECKSUM"),
        "tile 7 OTHER speaks protocol 1, these tools speak 3: flash it with the firmware that belongs to "
        "them (tilenca flash)": OtherVersionSentence(1, 7),
    }
    for expected, sentence in sentences.items():
        line = log_line(Heard(0.0, "/dev/ttyACM0", b"", sentence))
        assert line.endswith(f":00.000 /dev/ttyACM0 {expected}")


def test_a_tile_that_fell_silent_is_marked() -> None:
    view = TileView("p")
    view.take(PortNews(0.0, "p", is_open=True))
    view.take(Heard(10.0, "p", b"", HelloSentence(3, 7, 0, 21, 10, 10000, 0, 0, 0, 255)))
    assert cells(view, 25.0)[-1] == ""
    assert cells(view, 31.0)[-1] == "silent"
    view.take(PortNews(32.0, "p", is_open=False, reason="went away"))
    assert cells(view, 33.0)[-1] == "went away"


def test_a_tile_of_another_protocol_version_is_marked() -> None:
    view = TileView("p")
    view.take(PortNews(0.0, "p", is_open=True))
    view.take(Heard(1.0, "p", b"", OtherVersionSentence(1, 7)))
    assert cells(view, 1.0)[-1] == "speaks protocol 1: flash it"
    view.take(Heard(2.0, "p", b"", HelloSentence(3, 7, 0, 21, 10, 100, 0, 0, 0, 255)))
    view.take(Heard(3.0, "p", b"", ErrorSentence(7, 0, "STACK", "")))
    assert cells(view, 3.0)[-1] == "STACK"
