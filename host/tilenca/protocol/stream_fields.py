"""Checks of a command's fields: each returns the value, or says in words what it must be."""

from collections.abc import Callable
from dataclasses import MISSING, field
from typing import Any, TypeAlias

from tilenca.base.sides import SIDES

MAX_PLACE = 64  # rows and columns are -MAX_PLACE..MAX_PLACE
MOST_TILES = 144
MAX_NAME = 256  # a port may lie deep in the tree

# Raises ValueError where the value is not what it must be.
Check: TypeAlias = Callable[[object], Any]


def whole(low: int, high: int) -> Check:
    """A whole number in low..high."""

    def check(value: object) -> int:
        if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
            raise ValueError(f"must be a whole number in {low}..{high}")
        return value

    return check


def number(low: float, high: float, or_zero: bool = False) -> Check:
    """A number in low..high, or also 0; as a float."""

    def check(value: object) -> float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not (low <= value <= high or (or_zero and value == 0)):  # type: ignore[operator]
            raise ValueError(f"must be a number in {low:g}..{high:g}{' or 0' if or_zero else ''}")
        return float(value)  # type: ignore[arg-type]

    return check


def switch(value: object) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise ValueError("must be true or false")
    return value


def text(value: object) -> str:
    """A printable text of 1 to MAX_NAME characters."""
    if not isinstance(value, str) or not 0 < len(value) <= MAX_NAME or not value.isprintable():
        raise ValueError(f"must be a text of 1 to {MAX_NAME} characters")
    return value


def one_of(*words: str) -> Check:
    """One of some words."""

    def check(value: object) -> str:
        if not isinstance(value, str) or value not in words:
            raise ValueError(f"must be one of {', '.join(words)}")
        return value

    return check


side = one_of(*SIDES)


def list_of(most: int, check: Check, what: str) -> Check:
    """A list of so many at most, each of which is checked; `what` they are, in words."""

    def check_all(value: object) -> tuple[Any, ...]:
        if not isinstance(value, list) or len(value) > most:
            raise ValueError(f"must be a list of at most {most} {what}")
        return tuple(check(item) for item in value)

    return check_all


place = whole(-MAX_PLACE, MAX_PLACE)


def _cell(value: object) -> tuple[int, int]:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError("must be places, [row, column] each")
    return place(value[0]), place(value[1])


def cells(value: object) -> tuple[tuple[int, int], ...]:
    """1 to MOST_TILES different places, as tuples."""
    found: tuple[tuple[int, int], ...] = list_of(MOST_TILES, _cell, "places")(value)
    if not found or len(set(found)) != len(found):
        raise ValueError(f"must be 1 to {MOST_TILES} different places")
    return found


def or_none(check: Check) -> Check:
    """None, or what the other check wants."""
    return lambda value: None if value is None else check(value)


def checked(check: Check, default: object = MISSING) -> Any:
    """A field of a command: how it is checked, and what it is where it is left out."""
    if default is MISSING:
        return field(metadata={"check": check})
    return field(default=default, metadata={"check": check})
