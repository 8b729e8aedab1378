"""Each pattern takes its own sentence of the shared vectors' form, and no other's."""

import pytest

from tilenca.protocol import patterns

EXAMPLES = {
    "HELLO": "HELLO,3,7,BEEF,21,11,100,0,01,0123ABCD,64",
    "TILE": "TILE,7,1200,34,4,4,100,N-S-,80FF00",
    "LINK": "LINK,7,1200,E,10,9,1,0,0,50,0,8,W",
    "TIME": "TIME,7,1200,30000,400,90,2000,0",
    "ERROR": "ERROR,7,12,SETTINGS,defaults in force",
    "ACK": "ACK,7,SET,id,7",
    "NAK": "NAK,7,RANGE,SET",
    "TILE_2": "TILE,7,1200,34,4,N-S-,80FF00",
    "LINK_1": "LINK,7,1200,E,10,9,1,0,0,50",
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_pattern_takes_its_own_sentence_and_no_other(name: str) -> None:
    pattern = getattr(patterns, name)
    assert [other for other, text in EXAMPLES.items() if pattern.fullmatch(text)] == [name]


def test_a_greeting_of_any_version_has_a_version_and_a_tile() -> None:
    found = patterns.OTHER_HELLO.fullmatch("HELLO,9,7,whatever,comes")
    assert found is not None
    assert found.groups() == ("9", "7")


def test_a_sentence_is_framed_by_a_dollar_and_a_checksum() -> None:
    assert patterns.SENTENCE.fullmatch(b"$NAK,7,RANGE,SET*1F")
    for line in (b"NAK,7,RANGE,SET*1F", b"$NAK,7,RANGE,SET", b"$NAK*7*1F", b"$NAK,7,\xc3*1F", b"$NAK*1f"):
        assert patterns.SENTENCE.fullmatch(line) is None
