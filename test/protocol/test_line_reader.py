"""From bytes to what is known of a tile: nothing raises, nothing good is missed, nothing bad believed."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from support.strategies import sentences
from tilenca.protocol.constants import MAX_SENTENCE
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.sentences import (
    LinkSentence,
    Sentence,
    TileSentence,
    format_sentence,
    parse_sentence,
)

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


def test_a_line_is_complete_at_the_byte_that_ends_it_or_is_one_too_many() -> None:
    reader = LineReader()
    assert [at for at, _ in reader.feed_at(b"$AS")] == []
    assert reader.feed_at(b"K*45\r\n$") == [(4, (b"$ASK*45", None))]
    assert reader.feed_at(b"noise$") == [(5, (b"$noise", None))]
    endless = b"n" * MAX_SENTENCE
    assert reader.feed_at(endless) == [(MAX_SENTENCE - 1, (b"$" + endless, None))]
