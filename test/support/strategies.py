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
