"""A run, step by step."""

import numpy as np
import pytest

from support.films import change_of, film_of
from tilenca.simulator.trace import NOTHING, Film


def test_a_film_begins_dark_and_ends_as_the_shape() -> None:
    film = film_of("4")
    assert film.shown.shape == (13, 10)
    assert (film.shown[0] == NOTHING).all()
    assert (film.shown[-1] == 4).all()
    assert film.agreed_at is not None
    assert not film.right[film.agreed_at - 1]
    assert film.right[film.agreed_at :].all()


def test_a_film_that_does_not_end_right_has_not_agreed() -> None:
    there = np.ones((2, 5), np.bool_)
    cells = tuple((row, 0) for row in range(5))
    film = Film("1", cells, ("0", "1"), np.array([[1] * 5, [1, 1, 0, 1, 1]]), there, np.array([1, 1]), "")
    assert film.agreed_at is None
    assert list(film.right) == [True, False]
    there[1, 2] = False  # what is not there is not wrong
    assert list(film.right) == [True, True]


def test_the_same_seed_gives_the_same_film_and_another_seed_another() -> None:
    np.testing.assert_array_equal(film_of("8").shown, film_of("8").shown)
    assert (film_of("8").shown != film_of("8", seed=2).shown).any()


@pytest.mark.parametrize("between", [0, 3])
def test_tiles_are_rebuilt_into_another_shape_while_they_run(between: int) -> None:
    film = change_of("4", "8", steps=20, between=between)
    changed = int((film.there[0] != film.there[-1]).sum())
    moves = int((film.there[1:] != film.there[:-1]).any(axis=1).sum())
    assert (film.there[0].sum(), film.there[-1].sum()) == (10, 16)
    assert moves == (changed if between else 1)
    assert len(film.shown) == 1 + 20 + (moves - 1) * between + 20
    assert set(film.wanted) == ({4, 8, NOTHING} if between else {4, 8})
    assert film.right[20]
    assert film.right[-1]
    assert (film.shown[~film.there] == NOTHING).all()
    assert film.agreed_at is not None
    assert film.agreed_at > 20
    assert film.eventful[0] == 0
    assert 21 in film.eventful
