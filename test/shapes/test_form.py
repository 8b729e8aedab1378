"""Forms: drawn alike at all sizes, legible or not drawn at all."""

import numpy as np
import pytest

from tilenca.shapes.cells import cells_of, connected
from tilenca.shapes.form import make_form
from tilenca.shapes.skeleton import of_rows
from tilenca.shapes.stretch import stretch
from tilenca.shapes.vary import Vary

STILL = Vary(slant=0, turn=0, bars=0, jitter=0, corners=0, ends=0)
WILD = Vary(slant=0.5, turn=20, bars=0.4, jitter=0.1, corners=1, ends=0.4, hooks=0.4, feet=0.4)
DIGITS = {
    "4": ("#..#", "#..#", "####", "...#", "...#"),
    "8": ("####", "#..#", "####", "#..#", "####"),
    "1": ("#", "#", "#"),
    "P": ("##", "##", "#."),
}


@pytest.mark.parametrize("label", DIGITS)
@pytest.mark.parametrize("size", [(5, 4), (9, 7), (13, 10)])
def test_without_any_change_a_form_is_the_stretched_drawing(label: str, size: tuple[int, int]) -> None:
    rows = DIGITS[label]
    form = make_form(of_rows(rows), STILL, np.random.default_rng(1))
    wanted = (size[0], 1) if label == "1" else size
    assert form.draw(wanted) == stretch(rows, *wanted)


@pytest.mark.parametrize("seed", range(30))
def test_a_drawn_form_is_connected_and_has_its_holes(seed: int) -> None:
    random = np.random.default_rng(seed)
    drawn = 0
    for label, rows in DIGITS.items():
        form = make_form(of_rows(rows), WILD, random)
        for pen in ((1, 1), (2, 2)):
            found = form.draw((12, 10), pen)
            if found is not None:
                assert connected(cells_of(found)), label
                drawn += 1
    assert drawn > 0


def test_an_eight_too_small_for_its_holes_is_not_drawn() -> None:
    form = make_form(of_rows(DIGITS["8"]), STILL, np.random.default_rng(1))
    assert form.draw((5, 4), (2, 2)) is None
    assert form.draw((4, 3)) is None
    assert form.draw((8, 5), (2, 2)) is not None


def test_a_five_whose_gap_closes_is_not_drawn() -> None:
    form = make_form(of_rows(("####", "#...", "####", "...#", "####")), STILL, np.random.default_rng(1))
    assert form.draw((5, 4), (2, 1)) is None


def test_all_sizes_of_a_form_share_its_key_and_other_forms_have_others() -> None:
    random = np.random.default_rng(3)
    keys = [make_form(of_rows(DIGITS["4"]), WILD, random).key() for _ in range(50)]
    assert len(set(keys)) > 40
    same = make_form(of_rows(stretch(DIGITS["4"], 9, 8) or ()), STILL, random)
    assert same.key() == make_form(of_rows(DIGITS["4"]), STILL, random).key()
