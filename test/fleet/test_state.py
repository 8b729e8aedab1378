"""What is known of a tile and of a fleet, from what they say."""

from dataclasses import replace

from tilenca.fleet.events import Reporter
from tilenca.fleet.state import Fleet, PortNews, TileView, as_json
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import (
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
    format_sentence,
)
from tilenca.views.fleet_table import cells, log_line, summary

HELLO = HelloSentence(3, 7, 0xBEEF, 21, 10, 250, 0, 4, 0xC0FFEE, 255)
TILE = TileSentence(7, 1200, 12, "4", 4, 30, "N-SW", bytes(range(1, 22)))
LINK = LinkSentence(7, 1201, "E", 100, 98, 2, 3, 1, 15, 0, 8, "W")


def view_of(*sentences: Sentence) -> TileView:
    fleet = Fleet()
    fleet.take(PortNews(0.0, "p", is_open=True))
    for second, sentence in enumerate(sentences, start=1):
        fleet.take(Heard(float(second), "p", b"", sentence))
    return fleet.tiles["p"]


def test_a_view_sums_the_last_report_of_each_side() -> None:
    newer = replace(LINK, uptime_ms=1300, sent=110, received=108, age_ms=5)
    west = LinkSentence(7, 1400, "W", 50, 49, 1, 0, 0, None, 0, None, None)
    view = view_of(TILE, LINK, newer, west)
    assert (view.tile_id, view.tile, view.sentences, view.heard_s) == (7, TILE, 4, 4.0)
    assert [view.total(counter) for counter in ("sent", "received", "corrupt", "lost")] == [160, 157, 3, 3]


def test_a_hello_forgets_what_was_before_the_reset() -> None:
    view = view_of(TILE, LINK, OtherVersionSentence(1, 7), ErrorSentence(7, 1, "STACK", ""), HELLO)
    assert (view.hello, view.tile, view.total("received")) == (HELLO, None, None)
    assert (view.error, view.other_version) == (None, None)


def test_a_view_knows_times_and_errors_and_who_speaks_another_version() -> None:
    time, error = TimeSentence(7, 1000, 14200, 163, 2048, 5000, 0), ErrorSentence(7, 5, "SETTINGS", "x")
    view = view_of(time, error, OtherVersionSentence(1, 7), NakSentence(7, "VALUE", "SET"))
    assert (view.time, view.error, view.other_version) == (time, error, 1)


def test_damage_and_outages_are_counted() -> None:
    fleet = Fleet()
    for event in (
        PortNews(1.0, "p", is_open=False, reason="no such port"),
        PortNews(2.0, "p", is_open=True),
        Heard(3.0, "p", b"$x", None),
        PortNews(4.0, "p", is_open=False, reason="went away"),
        PortNews(5.0, "p", is_open=False, reason="no such port"),
        PortNews(6.0, "p", is_open=True),
    ):
        fleet.take(event)
    view = fleet.tiles["p"]
    assert (view.outages, view.damaged, view.sentences, view.is_open, view.reason) == (1, 1, 0, True, "")


def test_a_board_under_test_is_no_damage_and_is_named_until_it_is_a_tile_again() -> None:
    line = "side N: FAIL, heard nothing: no plug, no tile, or a broken line to PD2"
    fleet, news = Fleet(), Heard(2.0, "p", line.encode(), None)
    fleet.take(PortNews(1.0, "p", is_open=True))
    fleet.take(news)
    view = fleet.tiles["p"]
    assert view.damaged == 0
    assert log_line(news).endswith(f" p - {line}")
    assert [(told.text, told.bad) for told in Reporter(fleet).take(news)] == [(f"{BOARD_TEST}: {line}", True)]
    assert cells(view, 2.0)[-1] == BOARD_TEST
    assert BOARD_TEST in summary([view])
    fleet.take(Heard(3.0, "p", b"", TILE))
    assert cells(view, 3.0)[-1] == ""


def test_json_has_tile_port_time_type_and_fields() -> None:
    assert as_json(Heard(12.3456, "/dev/ttyACM0", format_sentence(TILE).strip(), TILE)) == {
        "time": 12.346,
        "port": "/dev/ttyACM0",
        "tile": 7,
        "type": "TILE",
        "fields": {
            "uptime_ms": 1200,
            "updates": 12,
            "label": "4",
            "class_index": 4,
            "margin": 30,
            "links": "N-SW",
            "state": bytes(range(1, 22)).hex().upper(),
        },
    }


def test_a_model_id_is_four_hex_digits_in_json_too() -> None:
    fields = as_json(Heard(0.0, "p", b"", replace(HELLO, model_id=0xAB)))["fields"]
    assert (fields["model_id"], fields["firmware_id"]) == ("00AB", "00C0FFEE")


def test_a_port_that_is_heard_is_open_unless_news_say_that_it_went_away() -> None:
    fleet = Fleet()
    fleet.take(Heard(1.0, "p", b"", TILE))
    assert fleet.tiles["p"].is_open
    fleet.take(PortNews(2.0, "p", is_open=False, reason="unplugged"))
    fleet.take(Heard(2.1, "p", b"", TILE))  # read before
    assert not fleet.tiles["p"].is_open
    assert fleet.tiles["p"].outages == 1
