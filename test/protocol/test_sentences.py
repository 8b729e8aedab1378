"""The Python twin of the protocol, on the cases that the C++ twin is tested with, and under fuzzing."""

import importlib.util

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.vectors import VECTORS, cases
from tilenca.protocol.checksums import checksum
from tilenca.protocol.constants import MAX_SENTENCE, PROTOCOL_VERSION
from tilenca.protocol.sentences import (
    AckSentence,
    BoardSentence,
    ChipSentence,
    ErrorSentence,
    HelloSentence,
    LinkSentence,
    NakSentence,
    OtherVersionSentence,
    Sentence,
    TileSentence,
    TimeSentence,
    format_sentence,
    framed,
    parse_sentence,
)

u8, u16, u32 = (st.integers(0, 2**bits - 1) for bits in (8, 16, 32))
labels = st.sampled_from([*"0123456789AbCdEFGHhIJKLMnoPqrStUuVWXYZ-_="])
links = st.tuples(*(st.sampled_from([side, "-"]) for side in "NESW")).map("".join)
states = st.binary(min_size=1, max_size=51)
sides = st.sampled_from("NESW")
words = st.text("ABCXYZ", min_size=1, max_size=16)
texts = st.text("abcXYZ 0129.-", max_size=60)
sentences: st.SearchStrategy[Sentence] = st.one_of(
    st.builds(HelloSentence, st.just(PROTOCOL_VERSION), u8, u16, u8, u8, u16, u16, u8, u32, u8),
    st.builds(TileSentence, u8, u32, u32, st.just(""), st.none(), st.none(), links, states),
    st.builds(TileSentence, u8, u32, u32, labels, u8, st.none() | u8, links, states),
    st.builds(
        LinkSentence, u8, u32, sides, u32, u32, u32, u32, u32, st.none() | u32, u32,
        st.none() | u8, st.none() | sides,
    ),
    st.builds(TimeSentence, u8, u32, u32, u16, u32, u16, u32),
    st.builds(ChipSentence, u8, u8, u8, u8, u8),
    st.builds(ChipSentence, u8, u8, u8, u8, u8, u8, u16),
    st.builds(BoardSentence, u8, u32, st.none() | u16, st.tuples(*[u16] * 4), st.tuples(*[u32] * 4)),
    st.builds(ErrorSentence, u8, u32, words, texts),
    st.builds(AckSentence, u8, words, st.lists(texts.filter(len), max_size=2).map(tuple)),
    st.builds(NakSentence, u8, words, texts),
)  # fmt: skip


def test_the_shared_files_are_what_their_script_writes() -> None:
    spec = importlib.util.spec_from_file_location("make_vectors", VECTORS / "make_vectors.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    for name, text in script.text_of_files().items():
        assert (VECTORS / name).read_text() == text, f"{name}: run python test/vectors/make_vectors.py"


SENTENCES: dict[str, Sentence] = {
    "hello of tile 7": HelloSentence(3, 7, 0xBEEF, 3, 2, 2000, 30, 0x0A, 0xC0FFEE, 128),
    "hello of a tile with directions": HelloSentence(3, 7, 0xBEEF, 3, 2, 2000, 30, 0x0A, 0xC0FFEE, 128, 4),
    "tile before its first update": TileSentence(0, 0, 0, "", None, None, "----", bytes([0xC0, 0x80, 0x80])),
    "tile after its first update": TileSentence(
        255, 4294967295, 1, "4", 0, 30, "N-S-", bytes([0xC0, 0x8A, 0x6C])
    ),
    "link that never heard a frame": LinkSentence(7, 5, "W", 0, 0, 0, 0, 0, None, 0, None, None),
    "link with a corrupt frame": LinkSentence(7, 300, "E", 1, 3, 1, 0, 0, 210, 12, 200, "W"),
    "time": TimeSentence(7, 1000, 14200, 163, 2048, 5000, 3),
    "chip": ChipSentence(7, 0xFF, 0xD8, 0xFD, 0xCF),
    "chip on a marked board": ChipSentence(7, 0xFF, 0xD8, 0xFD, 0xCF, 2, 1017),
    "board whose supply is not known": BoardSentence(7, 500, None, (0,) * 4, (0,) * 4),
    "board with a line that is low": BoardSentence(
        7, 60500, 4380, (1, 0, 65535, 12), (0, 0, 60000, 4294967295)
    ),
    "error of a low supply": ErrorSentence(7, 1500, "SUPPLY", "4380 mV"),
    "error without an address": ErrorSentence(7, 12, "SETTINGS", "defaults in force"),
    "error with an address": ErrorSentence(0, 3, "WATCHDOG", "hung at 0x00A2C"),
    "answer to a period": AckSentence(7, "SET", ("period", "20")),
    "answer to a preset": AckSentence(7, "SET", ("preset", "paper")),
    "answer to a marking": AckSentence(7, "MARK", ("2", "1017")),
    "a marking that is for good": NakSentence(7, "MARKED", "MARK"),
    "answer to a new id": AckSentence(9, "SET", ("id", "9")),
    "answer to blink": AckSentence(7, "BLINK", ("5",)),
    "answer to restart": AckSentence(7, "RESTART"),
    "a damaged command": NakSentence(7, "CHECKSUM"),
    "a command too long": NakSentence(7, "LONG"),
    "a command nobody knows": NakSentence(7, "UNKNOWN", "FLY"),
    "a value out of range": NakSentence(7, "VALUE", "SET"),
    "an EEPROM that does not keep": NakSentence(7, "EEPROM", "SET"),
}


def test_sentence_cases() -> None:
    lines = {name: line for name, line in cases("sentences.inc")}  # noqa: C416
    assert lines.keys() == SENTENCES.keys()
    for name, sentence in SENTENCES.items():
        assert parse_sentence(lines[name]) == sentence
        assert format_sentence(sentence) == lines[name].encode() + b"\r\n"


@pytest.mark.parametrize(
    ("text", "version"),
    [
        ("HELLO,1,7,BEEF,3,2,2000,30,0A", 1),
        ("LINK,7,5,W,0,0,0,0,0,", 1),
        ("LINK,7,300,E,1,3,1,0,0,210", 1),
        ("TILE,7,100,3,4,N-S-,C08A6C", 2),
        ("TILE,7,100,0,,----,C08080", 2),
        ("HELLO,2,7,BEEF,3,2,2000,30,0A,00C0FFEE,128", 2),
        ("HELLO,4,7,whatever comes", 4),
        ("HELLO,1,7,BEEF,3,2,2000,30,0A,00C0FFEE,128", 1),
    ],
)
def test_another_version_is_told_with_its_remedy(text: str, version: int) -> None:
    sentence = parse_sentence(framed(text))
    assert sentence == OtherVersionSentence(version, 7)
    assert f"protocol {version}, these tools speak 3: flash" in OtherVersionSentence(version, 7).remedy


@given(sentences)
def test_a_sentence_comes_back_within_its_length(sentence: Sentence) -> None:
    line = format_sentence(sentence)
    assert len(line) <= MAX_SENTENCE
    assert parse_sentence(line) == sentence
    assert parse_sentence(line.decode("ascii")) == sentence


@given(sentences, st.data())
def test_a_changed_character_is_noticed(sentence: Sentence, data: st.DataObject) -> None:
    line = bytearray(format_sentence(sentence)[:-2])
    at = data.draw(st.integers(0, len(line) - 1))
    line[at] ^= data.draw(st.integers(1, 255))
    assert parse_sentence(bytes(line)) is None


@given(st.binary() | st.text())
def test_parsing_anything_never_raises(line: bytes | str) -> None:
    parse_sentence(line)


@given(st.binary(max_size=120).map(lambda body: b"$%s*%02X" % (body, checksum(body))))
def test_a_good_checksum_alone_is_no_sentence(line: bytes) -> None:
    assert parse_sentence(line) is None


@pytest.mark.parametrize(
    "body",
    [
        b"TILE,1,2,3,4,4,30,NESW,ABC",  # half a byte of state
        b"TILE,1,2,3,44,4,30,NESW,AB",  # two labels
        b"TILE,1,2,3,4,4,30,ENSW,AB",  # sides out of order
        b"TILE,1,2,3,4,4,30,NESW," + b"AB" * 52,  # more channels than there are
        b"TILE,-1,2,3,4,4,30,NESW,AB",
        b"TILE,1,2,3,4,4,30,NESW,ab",
        b"TILE,1,2,3,4,,30,NESW,AB",  # a label without a class
        b"TILE,1,2,3,,4,30,NESW,AB",  # a class without a label
        b"TILE,1,2,3,,,30,NESW,AB",  # a margin of nothing
        b"TILE,1,2,3,4,4,-1,NESW,AB",
        b"TILE,1,2,3,4,4,NESW,AB",
        b"LINK,1,2,X,3,4,5,6,7,8,0,,",
        b"LINK,1,2,N,3,4,5,6,7",
        b"LINK,1,2,N,3,4,5,6,7,8,0,1,X",
        b"HELLO,3,2,ABCD,3,4,5,6,G0,00000000,1",
        b"HELLO,3,2,ABCD,3,4,5,6,00",
        b"TIME,1,2,3,4,5,6",
        b"BOARD,1,2,5000,0,0,0,0,0,0,0",
        b"BOARD,1,2,5000,0,0,0,0,0,0,0,",
        b"ERROR,1,2,lower,text",
        b"ACK,1",
        b"NAK,1,VALUE",
        b"FUTURE,1,2,3",
        b"",
    ],
)
def test_wrong_fields_with_a_good_checksum_are_refused(body: bytes) -> None:
    assert parse_sentence(b"$%s*%02X" % (body, checksum(body))) is None
