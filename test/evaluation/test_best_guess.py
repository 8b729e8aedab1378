"""What tiles could do at best where a dead tile cuts their drawing."""

from itertools import product

import pytest

from tilenca.base import paths
from tilenca.evaluation.best_guess import best_share, cuts_of, guessed_share, pieces
from tilenca.shapes.file import Shape, load_task

PLUS = Shape("+", (".#.", "###", ".#."), "+")
LINE = Shape("1", ("#", "#", "#"), "1")


def test_pieces_are_the_connected_parts() -> None:
    assert list(pieces(set())) == []
    found = {frozenset(piece) for piece in pieces({(0, 0), (0, 1), (2, 0), (3, 0), (3, 1), (5, 5)})}
    assert found == {frozenset({(0, 0), (0, 1)}), frozenset({(2, 0), (3, 0), (3, 1)}), frozenset({(5, 5)})}


def test_every_tile_of_every_drawing_is_cut_out_once() -> None:
    cuts = cuts_of([PLUS, LINE])
    assert len(cuts) == 8
    assert sum(cut.weight for cut in cuts) == pytest.approx(1)
    assert [len(cut.pieces) for cut in cuts if cut.label == "1"] == [1, 1, 1], (
        "both halves are the same piece"
    )


def test_one_drawing_alone_is_always_guessed() -> None:
    assert best_share((PLUS,)) == pytest.approx(1)


def test_a_piece_that_two_drawings_leave_is_given_to_the_one_that_it_serves_best() -> None:
    # The middle tile of the cross leaves single tiles, and so does that of the line: only one can be right.
    # Each drawing weighs 1/2, so a tile of the line weighs 1/6, and one of the cross 1/10.
    assert best_share((PLUS, LINE)) == pytest.approx(1 - 1 / 10)


def test_a_piece_that_is_a_whole_drawing_is_taken_for_that_drawing() -> None:
    pair = Shape("2", ("#", "#"), "2")
    # A line without an end is a pair; without its middle it is two single tiles, which a pair leaves, too.
    assert best_share((LINE, pair)) == pytest.approx(1 / 2)


def test_no_answers_to_the_pieces_of_three_digits_do_better() -> None:
    """Every answer to every piece, tried one by one."""
    shapes = tuple(shape for shape in load_task(paths.DEFAULT_SHAPES).shapes if shape.label in "147")
    cuts = cuts_of(shapes)
    whole = {shape.rows: shape.label for shape in shapes}
    claims = {p: sorted({c.label for c in cuts if p in c.pieces}) for cut in cuts for p in cut.pieces}
    open_ones = [p for p, labels in claims.items() if p not in whole and len(labels) > 1]
    alone = {p: labels[0] for p, labels in claims.items() if p not in whole and len(labels) == 1}
    best = 0.0
    for choice in product(*(claims[p] for p in open_ones)):
        answers = whole | alone | dict(zip(open_ones, choice, strict=True))
        best = max(best, sum(c.weight for c in cuts if all(answers[p] == c.label for p in c.pieces)))
    assert best_share(shapes) == pytest.approx(best)
    assert best < 1


def test_a_guess_takes_the_likeliest_drawing_that_could_leave_the_piece() -> None:
    bar, ell = Shape("I", ("#", "#", "#"), "I"), Shape("L", ("#.", "#.", "##"), "L")
    gone, left = 0.2, 0.8
    # A column of two or three tiles is an I, for which fewer tiles must be dead; anything else is an L.
    of_bar = left**3 + 2 * gone * left**2
    of_ell = 1 - 2 * (gone * left**3 + gone**2 * left**2)
    assert guessed_share((bar, ell), gone, 4000, 1) == pytest.approx((of_bar + of_ell) / 2, abs=0.03)
    assert guessed_share((bar, ell), 0.0, 50, 1) == 1.0
