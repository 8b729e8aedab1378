"""What the page offers to lay out."""

from pathlib import Path

import pytest

from tilenca.base.errors import UsageError
from tilenca.base.paths import DEFAULT_SHAPES
from tilenca.page.offer import load_offer


def test_without_a_file_it_has_the_digits_at_three_sizes() -> None:
    offer = load_offer()
    assert offer.labels[:10] == tuple("0123456789")
    names = [drawing.name for drawing in offer.drawings]
    assert len(set(names)) == len(names)
    assert {"digits/8", "digits-3x3/4", "digits-7x6/0"} <= set(names)


def test_labels_of_several_files_are_there_once() -> None:
    offer = load_offer([DEFAULT_SHAPES, DEFAULT_SHAPES.with_name("digits-3x3.toml")])
    assert offer.labels == tuple("0123456789")
    assert [drawing.shape.label for drawing in offer.drawings[:10]] == list("0123456789")


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"none\.toml"):
        load_offer([tmp_path / "none.toml"])
