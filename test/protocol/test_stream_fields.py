"""Checks of a command's fields: what is right comes back, what is not is said in words."""

from typing import Any

import pytest

from tilenca.protocol import stream_fields as must_be

GOOD: list[tuple[must_be.Check, object, object]] = [
    (must_be.whole(-2, 3), 3, 3),
    (must_be.number(0.5, 2), 1, 1.0),
    (must_be.number(0.5, 2, or_zero=True), 0, 0.0),
    (must_be.switch, False, False),
    (must_be.text, "tile-01", "tile-01"),
    (must_be.side, "W", "W"),
    (must_be.place, -must_be.MAX_PLACE, -must_be.MAX_PLACE),
    (must_be.cells, [[0, 1], [2, 3]], ((0, 1), (2, 3))),
    (must_be.or_none(must_be.side), None, None),
    (must_be.list_of(2, must_be.side, "sides"), ["N", "N"], ("N", "N")),
]
BAD: list[tuple[must_be.Check, Any, str]] = [
    (must_be.whole(-2, 3), 4, "whole number in -2..3"),
    (must_be.whole(0, 3), True, "whole number"),
    (must_be.number(0.5, 2), float("nan"), "number in 0.5..2"),
    (must_be.number(0.5, 2), "1", "number in 0.5..2"),
    (must_be.number(0.5, 2, or_zero=True), 0.1, "or 0"),
    (must_be.switch, 1, "true or false"),
    (must_be.text, "a\n", "1 to 256 characters"),
    (must_be.side, "NE", "one of N, E, S, W"),
    (must_be.cells, [[0, 1], [0, 1]], "different places"),
    (must_be.cells, [[0, 65]], "whole number in -64..64"),
    (must_be.cells, [[0]], "[row, column] each"),
    (must_be.list_of(1, must_be.side, "sides"), ["N", "N"], "at most 1 sides"),
]


@pytest.mark.parametrize(("check", "value", "result"), GOOD)
def test_what_is_right_comes_back(check: must_be.Check, value: object, result: object) -> None:
    assert check(value) == result


@pytest.mark.parametrize(("check", "value", "words"), BAD)
def test_what_is_wrong_is_said(check: must_be.Check, value: object, words: str) -> None:
    with pytest.raises(ValueError, match="must be") as caught:
        check(value)
    assert words in str(caught.value)
