"""Sentences and bytes in words that a person reads."""

import pytest
from hypothesis import given

from support.strategies import sentences
from tilenca.protocol.describe import SHOWN_BYTES, printable, reset_words, said, whole_number, words
from tilenca.protocol.sentences import Sentence


def test_bytes_cannot_disturb_the_terminal() -> None:
    assert printable(b"\x1b[2J\xff\n" + b"x" * 100).isprintable()


def test_long_garbage_is_cut_and_its_length_told() -> None:
    assert printable(b"$TILE,7") == "$TILE,7"
    assert printable(b"x" * SHOWN_BYTES) == "x" * SHOWN_BYTES
    assert printable(b"x" * (SHOWN_BYTES + 1)) == "x" * SHOWN_BYTES + f"... ({SHOWN_BYTES + 1} bytes)"


@pytest.mark.parametrize(
    ("cause", "text"),
    [
        (0, "unknown"),
        (1, "power-on"),
        (2, "its reset pin"),
        (4 | 8, "brown-out and watchdog"),
        (0x1F, "power-on and its reset pin and brown-out and watchdog and JTAG"),
        (0xE0, "unknown"),
    ],
)
def test_every_bit_of_a_reset_has_its_cause(cause: int, text: str) -> None:
    assert reset_words(cause) == text


@pytest.mark.parametrize(("text", "number"), [("0", 0), ("-5", -5), ("007", 7), ("999999999", 999_999_999)])
def test_a_number_in_plain_digits_is_one(text: str, number: int) -> None:
    assert whole_number(text) == number


@pytest.mark.parametrize("text", ["", "1.5", " 1", "1e3", "+1", "1_000", "\u0663", "1" * 10, "fast"])
def test_what_python_would_take_and_a_tile_would_not_is_none(text: str) -> None:
    assert whole_number(text) is None


@given(sentences)
def test_any_sentence_has_words_of_one_line(sentence: Sentence) -> None:
    text = said(sentence)
    assert text.startswith(f"tile {sentence.tile} ")
    assert text.isprintable()
    assert text.endswith(words(sentence))
