"""How faults are written: all that a command or an address can say, and what cannot be."""

import pytest

from tilenca.base.errors import UsageError
from tilenca.emulator.fault_spec import KINDS, FaultSpec, parse

GOOD = {
    "loss": ("loss=0.1", 0.1, "", 0.0, None),
    "flip": ("flip=0.001@3E", 0.001, "3E", 0.0, None),
    "delay": ("delay=5@3-4:2-3", 5.0, "3-4", 2.0, 3.0),
    "cut": ("cut@3-4:2-3", 0.0, "3-4", 2.0, 3.0),
    "off": ("off@7:2-3.5", 0.0, "7", 2.0, 3.5),
    "remove": ("remove@7:2", 0.0, "7", 2.0, None),
    "reset": ("reset@7:2", 0.0, "7", 2.0, None),
    "turn": ("turn@7:2-3", 0.0, "7", 2.0, 3.0),
    "drift": ("drift=20@7", 20.0, "7", 0.0, None),
    "adc": ("adc=2", 2.0, "", 0.0, None),
    "supply": ("supply=4.3@7:2-3", 4.3, "7", 2.0, 3.0),
    "skew": ("skew=-20000@7:2-3", -20_000.0, "7", 2.0, 3.0),
}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_is_read(kind: str) -> None:
    text, value, where, from_s, to_s = GOOD[kind]
    assert parse(text) == FaultSpec(text, kind, value, where, from_s, to_s)


@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("supply=1@2", "supply is 1.8 to 5.5 V"),
        ("supply=6@2", "supply is 0 to 5.5"),
        ("supply@2", "takes a number"),
        ("skew=-100001@2", "skew is -100000 to 100000"),
        ("skew=nan@2", "'nan' is no number"),
        ("drift=-1@2", "'-1' is no number"),
        ("turn:1-2", "turn needs a place"),
        ("turn=90@2", "turn takes no number"),
    ],
)
def test_what_cannot_be_is_refused_in_words(text: str, fact: str) -> None:
    with pytest.raises(UsageError, match=fact):
        parse(text)
