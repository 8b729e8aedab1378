"""The drawings that training draws by chance: of every kind, none that is held out, none of two classes."""

from dataclasses import replace

import numpy as np
import pytest

from tilenca.base import paths
from tilenca.shapes.batch import UNLABELLED, Drawings, load_training_task
from tilenca.shapes.cells import cells_of, connected
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.variant import TRAINED, split_of
from tilenca.training.generator import DAMAGED, FREE, OF_NO_CLASS, VARIED, Generator

KINDS = (VARIED, DAMAGED, OF_NO_CLASS, FREE)
LETTERS = paths.DEFAULT_SHAPES.parent / "letters.toml"


def task(path: object = paths.DEFAULT_SHAPES) -> Drawings:
    drawings, _ = load_training_task([path], 10.0, 30)  # type: ignore[list-item]
    return replace(drawings, labels=(*drawings.labels, UNKNOWN))


def generator(seed: int = 1, drawings: Drawings | None = None) -> Generator:
    given = drawings or task()
    return Generator(given, given.shapes, KINDS, 60, np.random.default_rng(seed))


DRAWER = generator()


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_that_is_held_out_is_drawn(kind: str) -> None:
    random = np.random.default_rng(2)
    drawn = {shape.rows for shape in task().shapes}
    shapes = [DRAWER.draw(kind, random) for _ in range(300)]
    assert all(split_of(shape.rows) == TRAINED for shape in shapes if shape.rows not in drawn)
    assert len({shape.rows for shape in shapes}) > 100
    assert max(len(shape.cells) for shape in shapes) <= DRAWER.most_tiles


def test_each_kind_has_its_labels() -> None:
    random = np.random.default_rng(3)
    labels = {kind: [DRAWER.draw(kind, random).label for _ in range(200)] for kind in KINDS}
    assert {*labels[VARIED]} - {UNLABELLED} == {*"0123456789"}
    assert {*labels[DAMAGED]} - {UNLABELLED} == {*"0123456789"}
    assert {*labels[OF_NO_CLASS]} == {UNKNOWN}
    assert labels[FREE].count(UNLABELLED) > 100
    assert labels[VARIED].count(UNLABELLED) < 10


def test_only_damaged_drawings_may_be_torn_apart() -> None:
    random = np.random.default_rng(4)
    torn = {
        kind: sum(not connected(cells_of(DRAWER.draw(kind, random).rows)) for _ in range(200))
        for kind in KINDS
    }
    assert torn[DAMAGED] > 5
    assert torn[VARIED] == torn[OF_NO_CLASS] == torn[FREE] == 0


def test_a_drawing_of_one_class_never_gets_another_label() -> None:
    known = {shape.rows: shape.label for shape in task().shapes}
    random = np.random.default_rng(5)
    for kind in KINDS:
        for _ in range(300):
            shape = DRAWER.draw(kind, random)
            assert (
                known.get(shape.rows, shape.label) in (shape.label, UNLABELLED) or shape.label == UNLABELLED
            )


def test_the_same_seed_draws_the_same() -> None:
    one, same = generator(7), generator(7)
    a, b = np.random.default_rng(8), np.random.default_rng(8)
    assert [one.draw(kind, a) for kind in KINDS * 10] == [same.draw(kind, b) for kind in KINDS * 10]


def test_a_task_without_variants_has_the_other_kinds() -> None:
    letters = replace(task(LETTERS), variants=None)
    drawer, random = generator(drawings=letters), np.random.default_rng(9)
    for kind in (DAMAGED, OF_NO_CLASS, FREE):
        assert len({drawer.draw(kind, random).rows for _ in range(50)}) > 20
    assert drawer.draw(VARIED, random) in letters.shapes  # nothing else turns up


def test_no_drawing_has_more_tiles_than_the_pools_have_room_for() -> None:
    """Blocks of 16 x 16 tiles without [vary]: strangers and variants of twice that size would come up."""
    rows = ("#" * 16,) * 16
    other = (*rows[:15], "#" * 15 + ".")
    shapes = (Shape("0", rows, "0"), Shape("1", other, "1"))
    many = replace(task(), shapes=shapes, groups=(0, 0), labels=("0", "1", UNKNOWN), variants=None)
    drawer, random = generator(drawings=many), np.random.default_rng(10)
    for kind in KINDS:
        assert all(len(drawer.draw(kind, random).cells) <= drawer.most_tiles for _ in range(30))


def test_what_cannot_be_drawn_of_no_class_is_in_doubt_and_never_of_a_class() -> None:
    pentominoes, _ = load_training_task([paths.DEFAULT_SHAPES.parent / "pentominoes.toml"], 1.0, 20)
    drawings = replace(pentominoes, labels=(*pentominoes.labels, UNKNOWN))
    drawer, random = generator(drawings=drawings), np.random.default_rng(11)
    labels = [drawer.draw(OF_NO_CLASS, random).label for _ in range(100)]
    assert labels.count(UNKNOWN) > 50
    assert {*labels} <= {UNKNOWN, UNLABELLED}
