"""The checks of the soak find what they are there for: frames counted wrong, memory that grows."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bench import ordeal_checks
from bench.ordeal_checks import Findings, LinkBooks, MemoryWatch, adds_up, memory_mb
from tilenca.base.sides import EAST, WEST
from tilenca.protocol.sentences import LinkSentence

SIDE = LinkSentence(1, 0, "E", 0, 0, 0, 0, 0, 0, 0, 2, "W")
PERIOD_S, TOLD_EVERY_S = 0.02, 0.1


def told(count: str, per_frame: float, begun: int = 100) -> list[tuple[float, LinkSentence]]:
    """What a side says in four seconds in which its neighbour sends a frame every 20 ms."""
    times = [TOLD_EVERY_S * i for i in range(40)]
    changes: list[dict[str, Any]] = [{count: begun + int(per_frame * at / PERIOD_S)} for at in times]
    return [(at, replace(SIDE, **change)) for at, change in zip(times, changes, strict=True)]


def test_counts_that_began_anywhere_add_up_and_one_of_ten_counted_twice_or_not_does_not() -> None:
    sent = told("sent", 1.0)
    for begun in (0, 100, 5000):
        assert adds_up(sent, told("received", 1.0, begun))
    assert not adds_up(sent, told("received", 0.85))
    assert not adds_up(sent, told("received", 1.15))


def test_both_directions_of_a_link_are_compared_and_named() -> None:
    books, findings = LinkBooks(), Findings()
    for (at, east), (_, west) in zip(told("sent", 1.0), told("received", 0.5), strict=True):
        books.hear(0, at, replace(east, side="E"))
        books.hear(1, at, replace(west, side="W"))
    link = (0, EAST, 1, WEST)
    assert books.check([link], findings) == [
        "tile 2 W counts otherwise than tile 1 E sends",
    ]
    assert (findings.links, findings.frames) == (2, 97)
    books.forget()
    assert books.check([link], findings) == []
    assert findings.links == 2


def test_frames_that_are_lost_add_up_and_are_counted() -> None:
    books, findings = LinkBooks(), Findings()
    for at, east in told("sent", 1.0):
        half = int(at / PERIOD_S / 2)
        books.hear(0, at, replace(east, side="E"))
        books.hear(1, at, replace(SIDE, side="W", received=half, lost=int(at / PERIOD_S) - half))
    assert books.check([(0, EAST, 1, WEST)], findings) == []
    assert findings.lost == 98


def test_memory_that_grows_in_the_second_half_is_a_finding(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for end_mb, wrong in ((41.0, None), (60.0, "memory grew from 40 to 60 MB in the second half")):
        held = iter((39.0, 40.0, end_mb))
        monkeypatch.setattr(ordeal_checks, "memory_mb", lambda held=held: next(held))
        watch = MemoryWatch()
        assert [watch.look(share) for share in (0.05, 0.1, 0.3, 0.55, 1.01, 1.02)] == [
            False, True, False, True, True, False,
        ]  # fmt: skip
        assert watch.drift() == wrong
        assert watch.words() == f"39 MB at 10 %, 40 MB at 50 %, {end_mb:.0f} MB at 100 %"
    monkeypatch.undo()
    assert 1 < memory_mb() < 10_000
