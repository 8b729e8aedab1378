"""The past of a run: which moments are kept, and which deeds are done again."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.page.timeline import EVERY_S, Timeline

Line = Timeline[str, str]


def ran(seconds: float, most_bytes: int = 10**9) -> Line:
    """A run that was looked at every hundredth of a second, with moments of one byte."""
    line: Line = Timeline(most_bytes=most_bytes)
    for tick in range(round(seconds * 100) + 1):
        if line.is_due(tick / 100):
            line.keep(tick / 100, f"{tick / 100:.2f}", 1)
        line.reached(tick / 100)
    return line


def test_moments_are_so_far_apart() -> None:
    line = ran(1.0)
    assert line.moments_s == pytest.approx([EVERY_S * number for number in range(21)])
    assert line.end_s == 1.0
    assert line.nearest(0.52) == (0.5, "0.50")
    assert line.nearest(0.5)[1] == "0.50"
    assert line.nearest(0.0)[1] == "0.00"


@given(st.integers(3, 40), st.integers(1, 40))
def test_where_room_is_short_the_past_gets_thinner_but_stays(most: int, seconds: int) -> None:
    line = ran(seconds, most)
    moments = line.moments_s
    assert len(moments) == min(most, seconds * 20 + 1)
    assert [moments[0], moments[-1]] == pytest.approx([0.0, seconds])
    assert moments == sorted(moments)


def test_the_gaps_grow_with_the_age() -> None:
    moments = ran(60, 40).moments_s
    gaps = [later - sooner for sooner, later in pairwise(moments)]
    assert max(gaps[-5:]) < 0.5
    assert max(gaps) < 15


def test_deeds_are_done_again_at_their_times_and_no_more_than_once() -> None:
    line = ran(1.0)
    line.note(1.0, "pull")
    line.keep(1.0, "pulled", 1)
    line.note(1.0, "put")
    line.keep(1.0, "put", 1)
    line.reached(2.0)
    assert line.deeds_in(0.5, 1.5) == [(1.0, "pull"), (1.0, "put")]
    assert line.deeds_in(0.5, 1.0) == [(1.0, "pull"), (1.0, "put")]
    assert line.deeds_in(1.0, 2.0) == []
    assert line.nearest(1.0) == (1.0, "put")


def test_deeds_that_are_planned_are_done_until_a_hand_does_another() -> None:
    line: Line = Timeline([(0.1, "one"), (0.3, "two")])
    assert line.deeds_in(0.0, 1.0) == [(0.1, "one"), (0.3, "two")]
    line.note(0.2, "other")
    assert line.deeds_in(0.0, 1.0) == [(0.1, "one"), (0.2, "other")]


def test_a_deed_in_the_past_begins_another_future() -> None:
    line = ran(1.0)
    line.note(0.8, "late")
    line.reached(1.5)
    line.note(0.42, "early")
    assert line.end_s == 0.42
    assert line.moments_s[-1] == pytest.approx(0.4)
    assert line.deeds_in(0.0, 9.0) == [(0.42, "early")]


def test_a_deed_at_the_very_beginning_is_in_the_first_moment() -> None:
    line = ran(0.0)
    line.note(0.0, "put")
    line.keep(0.0, "with it", 1)
    assert line.nearest(0.0) == (0.0, "with it")
    assert line.moments_s == [0.0]
