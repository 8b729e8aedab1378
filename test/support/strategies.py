"""Hypothesis strategies: any sentence of a tile."""

from hypothesis import strategies as st

from tilenca.protocol.constants import PROTOCOL_VERSION
from tilenca.protocol.sentences import (
    AckSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    Sentence,
    TileSentence,
    TimeSentence,
)

counts = st.integers(0, 2**32 - 1)
tiles = st.integers(0, 255)
bytes_ = st.integers(0, 254)
labels = st.sampled_from("0123456789AbCdEF-")
links = st.tuples(*(st.sampled_from([side, "-"]) for side in "NESW")).map("".join)
states = st.lists(st.integers(1, 255), min_size=1, max_size=51).map(bytes)
sentences: st.SearchStrategy[Sentence] = st.one_of(
    st.builds(
        HelloSentence,
        st.just(PROTOCOL_VERSION),
        tiles,
        st.integers(0, 0xFFFF),
        st.integers(1, 51),
        st.integers(1, 50),
        st.integers(10, 10000),
        st.integers(0, 0xFFFF),
        st.integers(0, 255),
        counts,
        st.integers(0, 255),
    ),
    st.builds(TileSentence, tiles, counts, counts, st.just(""), st.none(), st.none(), links, states),
    st.builds(TileSentence, tiles, counts, counts, labels, bytes_, st.none() | bytes_, links, states),
    st.builds(
        LinkSentence,
        tiles,
        counts,
        st.sampled_from("NESW"),
        counts,
        counts,
        counts,
        counts,
        counts,
        st.none() | counts,
        counts,
        st.none() | tiles,
        st.none() | st.sampled_from("NESW"),
    ),
    st.builds(TimeSentence, tiles, counts, counts, counts, counts, counts, counts),
    st.builds(ErrorSentence, tiles, counts, st.just("STACK"), st.text("ab c", max_size=30)),
    st.builds(AckSentence, tiles, st.just("SET"), st.just(("id", "7"))),
    st.builds(NakSentence, tiles, st.just("UNKNOWN"), st.text("AB", max_size=9)),
)


def damaged(whole: bytes) -> st.SearchStrategy[bytes]:
    """A good file with pieces of it replaced, left out or repeated; or any bytes at all.

    Among the pieces is what readers stumble over: brackets that never close, numbers that never end, bytes
    that are no UTF-8.
    """
    endless = [b"[" * 2000, b'{"a":' * 2000, b"9" * 5000]
    short = [b"1e999", b"null", b"[]", b"{}", b"-1", b"\xff", b"\0", b'"']
    pieces = st.binary(max_size=8) | st.sampled_from(endless + short)
    places = st.integers(0, len(whole))

    def spliced(changes: list[tuple[int, int, bytes]]) -> bytes:
        content = whole
        for place, length, piece in changes:
            content = content[:place] + piece + content[place + length :]
        return content

    changes = st.lists(st.tuples(places, st.integers(0, 12), pieces), min_size=1, max_size=4)
    return changes.map(spliced) | places.map(lambda place: whole[:place]) | pieces | st.binary()
