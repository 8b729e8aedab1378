"""Counts of runs add up in any order."""

import json
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.sweep.counts import Counts

INF = np.inf


def test_runs_are_right_dash_wrong_or_split() -> None:
    right = np.array([1.0, 0.5, 0.0, 0.0, 1.0])
    counts = Counts.of(right, np.array([3.0, INF, INF, INF, 7.0]), np.array([2, -2, 9, 4, 2]), 2, 9, 50)
    assert counts == Counts(5, 2, 1, 1, 1, 2.5, {3: 1, 7: 1}, 50)


def test_without_a_dash_there_is_none() -> None:
    counts = Counts.of(np.array([0.0]), np.array([INF]), np.array([3]), 2, None, 5)
    assert (counts.dash, counts.wrong) == (0, 1)


def test_a_dash_that_is_right_is_no_miss() -> None:
    counts = Counts.of(np.array([1.0]), np.array([1.0]), np.array([9]), 9, 9, 5)
    assert (counts.right, counts.dash, counts.wrong, counts.split) == (1, 0, 0, 0)


PARTS = st.lists(
    st.builds(
        Counts,
        runs=st.integers(1, 9),
        right=st.integers(0, 9),
        dash=st.integers(0, 9),
        wrong=st.integers(0, 9),
        split=st.integers(0, 9),
        cells=st.floats(0, 1e6),
        converged=st.dictionaries(st.integers(1, 60), st.integers(1, 9), max_size=4),
        updates=st.integers(0, 10**12),
    ),
    min_size=1,
    max_size=12,
)


@given(PARTS, st.randoms(use_true_random=False))
def test_the_order_of_the_parts_changes_no_bit(parts: list[Counts], chance: random.Random) -> None:
    shuffled = list(parts)
    chance.shuffle(shuffled)
    assert Counts.total(shuffled) == Counts.total(parts)


@given(PARTS)
def test_json_keeps_every_bit(parts: list[Counts]) -> None:
    for part in parts:
        assert Counts.from_json(json.loads(json.dumps(part.as_json()))) == part


def test_times_are_those_of_all_runs() -> None:
    assert Counts(10, 9, 0, 0, 1, 9.5, {5: 6, 8: 3}).times() == {"median": 5.0, "p95": None}
    assert Counts(20, 20, 0, 0, 0, 20.0, {5: 9, 8: 11}).times() == {"median": 8.0, "p95": 8.0}
    assert Counts(3, 0, 0, 0, 3, 0.0).times() == {"median": None, "p95": None}


def test_the_total_of_nothing_is_nothing() -> None:
    assert Counts.total([]).runs == 0
    assert Counts.total([]).cells == pytest.approx(0)
