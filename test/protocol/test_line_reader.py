"""From bytes to what is known of a tile: nothing raises, nothing good is missed, nothing bad believed."""

import itertools
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from support.strategies import sentences
from tilenca.fleet.events import Reporter
from tilenca.fleet.state import Fleet, PortNews, TileView, as_json
from tilenca.protocol.board_test import BOARD_TEST
from tilenca.protocol.constants import MAX_SENTENCE
from tilenca.protocol.line_reader import Heard, LineReader
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
    parse_sentence,
)
from tilenca.views.fleet_table import cells, log_line, summary

HELLO = HelloSentence(3, 7, 0xBEEF, 21, 10, 250, 0, 4, 0xC0FFEE, 255)
TILE = TileSentence(7, 1200, 12, "4", 4, 30, "N-SW", bytes(range(1, 22)))
LINK = LinkSentence(7, 1201, "E", 100, 98, 2, 3, 1, 15, 0, 8, "W")

# What a noisy line may carry between two sentences; without their own end, it must not swallow the next one.
noise = st.binary(max_size=400) | st.sampled_from(
    [b"$", b"$TILE,", b"$TILE,7*", b"*5A", b"\r", b"\0" * 300, b"$$$"]
)


def feed_in_pieces(reader: LineReader, stream: bytes, cuts: list[int]) -> list[tuple[bytes, Sentence | None]]:
    bounds = [0, *sorted(cut % (len(stream) + 1) for cut in cuts), len(stream)]
    return [line for start, end in itertools.pairwise(bounds) for line in reader.feed(stream[start:end])]


@given(st.lists(st.binary(max_size=600), max_size=20))
def test_arbitrary_bytes_never_raise_and_never_pile_up(pieces: list[bytes]) -> None:
    reader = LineReader()
    for piece in pieces:
        for raw, sentence in reader.feed(piece):
            assert sentence == parse_sentence(raw)
        assert len(reader._buffer) <= MAX_SENTENCE


@given(st.lists(st.tuples(noise, sentences)), noise, st.lists(st.integers(0, 10**6), max_size=10))
def test_every_good_sentence_between_bad_ones_is_found(
    parts: list[tuple[bytes, Sentence]], tail: bytes, cuts: list[int]
) -> None:
    stream = b"".join(junk + format_sentence(sentence) for junk, sentence in parts) + tail
    found = [sentence for _, sentence in feed_in_pieces(LineReader(), stream, cuts) if sentence is not None]
    expected = [sentence for _, sentence in parts]
    # Junk may by chance hold a good sentence of its own; ours are all there, in their order.
    remaining = iter(found)
    assert all(sentence in remaining for sentence in expected)


@given(sentences, st.data())
def test_one_flipped_bit_is_never_believed(sentence: Sentence, data: st.DataObject) -> None:
    line = bytearray(format_sentence(sentence))
    at = data.draw(st.integers(0, len(line) - 3))
    line[at] ^= 1 << data.draw(st.integers(0, 7))
    found = [heard for _, heard in LineReader().feed(bytes(line) + b"\n") if heard is not None]
    assert found == []


@given(st.lists(sentences, min_size=1, max_size=5), st.lists(st.integers(0, 10**6), max_size=10))
def test_lines_come_out_raw_however_they_are_cut(heard: list[Sentence], cuts: list[int]) -> None:
    stream = b"".join(map(format_sentence, heard))
    lines = feed_in_pieces(LineReader(), stream, cuts)
    assert [sentence for _, sentence in lines] == heard
    assert [raw + b"\r\n" for raw, _ in lines] == [format_sentence(sentence) for sentence in heard]


def test_a_damaged_line_is_told_with_its_bytes() -> None:
    reader = LineReader()
    stream = format_sentence(TILE) + b"TILE,7,lost its dollar*00\r\n" + format_sentence(LINK)
    assert [(raw, sentence) for raw, sentence in reader.feed(stream) if sentence is None] == [
        (b"TILE,7,lost its dollar*00", None)
    ]


def test_the_tail_of_the_line_one_joins_in_is_not_damage() -> None:
    stream = format_sentence(TILE)[10:] + format_sentence(LINK)
    assert [sentence for _, sentence in LineReader().feed(stream)] == [LINK]


def test_bytes_after_the_checksum_are_damage_and_the_sentence_stands() -> None:
    [(_, sentence), (rest, nothing)] = LineReader().feed(format_sentence(TILE).strip() + b"boom\n")
    assert (sentence, rest, nothing) == (TILE, b"boom", None)


def test_an_endless_line_is_cut_and_the_next_sentence_found() -> None:
    reader = LineReader()
    lines = [line for _ in range(10) for line in reader.feed(b"$" + b"x" * 150)] + reader.feed(
        format_sentence(TILE)
    )
    assert [sentence for _, sentence in lines if sentence] == [TILE]
    assert sum(sentence is None for _, sentence in lines) == 10


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
