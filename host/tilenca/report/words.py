"""What the report says in words (`words.toml`): its sections, why claims end, and what others do there."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any


@dataclass(frozen=True)
class Mark:
    """What others do at one value of a figure's axis.

    Attributes:
        across: the value.
        value: their share of the runs with all right; None: only that they hold so far.
        label: who.
    """

    across: float
    value: float | None
    label: str


@cache
def _words() -> dict[str, Any]:
    text = resources.files("tilenca.report").joinpath("words.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def introductions() -> dict[str, str]:
    """The introduction of each section, by its key."""
    return dict(_words()["introductions"])


def why(key: str) -> str:
    """Where the claim of an experiment ends, and why; empty where that needs no words."""
    return str(_words()["why"].get(key, ""))


def marks_of(key: str) -> tuple[Mark, ...]:
    """What others do on the axis of an experiment."""
    return tuple(
        Mark(mark["across"], mark.get("value"), mark["label"])
        for mark in _words()["marks"]
        if mark["figure"] == key
    )
