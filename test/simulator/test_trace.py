"""A run, step by step."""

import numpy as np

from support.films import film_of
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
    shape = film_of("1", steps=1).shape
    film = Film(shape, ("0", "1"), np.array([[1] * 5, [1, 1, 0, 1, 1]]), "")
    assert film.agreed_at is None
    assert list(film.right) == [True, False]


def test_the_same_seed_gives_the_same_film_and_another_seed_another() -> None:
    np.testing.assert_array_equal(film_of("8").shown, film_of("8").shown)
    assert (film_of("8").shown != film_of("8", seed=2).shown).any()
