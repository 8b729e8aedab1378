"""Plain text tables."""

import pytest

from tilenca.views.table import table


def test_columns_are_as_wide_as_their_widest_cell() -> None:
    assert table(("A", "LONG NAME", "C"), [("a cell", "1", "x"), ("b", "22", "y")]) == (
        "A       LONG NAME  C\na cell  1          x\nb       22         y"
    )


def test_no_line_ends_in_blanks() -> None:
    assert table(("A", "WHY"), [("long", ""), ("", "")]) == "A     WHY\nlong\n"


def test_a_header_may_stand_alone() -> None:
    assert table(("PORT", "TILE"), []) == "PORT  TILE"


def test_a_row_of_another_length_is_a_defect() -> None:
    with pytest.raises(ValueError, match="zip"):
        table(("A", "B"), [("1", "2", "3")])
