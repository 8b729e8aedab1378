"""The sentences' types: each has one name on the wire, and none can be changed after it was read."""

from dataclasses import FrozenInstanceError, fields
from typing import get_args

import pytest

from tilenca.protocol.sentence_types import LinkSentence, OtherVersionSentence, Sentence
from tilenca.protocol.sentences import TYPES


def test_each_type_has_a_name_of_its_own() -> None:
    assert set(TYPES) == set(get_args(Sentence))
    assert len(set(TYPES.values())) == len(TYPES)


def test_each_names_its_tile_and_most_their_time() -> None:
    for kind in get_args(Sentence):
        names = [field.name for field in fields(kind)]
        assert "tile" in names[:2], kind


def test_none_can_be_changed() -> None:
    link = LinkSentence(7, 0, "W", 1, 2, 3, 4, 5, None, 6, None, None)
    with pytest.raises(FrozenInstanceError):
        link.lost = 0  # type: ignore[misc]


def test_another_version_says_what_to_do() -> None:
    assert "tilenca flash" in OtherVersionSentence(2, 7).remedy
