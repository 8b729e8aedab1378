"""The distance between drawings."""

import numpy as np

from tilenca.base import paths
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.edits import grown
from tilenca.shapes.likeness import FEW_CLOSE, FEW_FAR, Likeness, index_of
from tilenca.shapes.stretch import stretch

RANDOM = np.random.default_rng(1)
FOUR = ("#..#", "#..#", "####", "...#", "...#")
ZERO = ("####", "#..#", "#..#", "#..#", "####")


def test_a_drawing_is_nearest_to_its_own_class_at_another_size() -> None:
    index = Likeness([FOUR, ZERO], RANDOM)
    larger = stretch(FOUR, 10, 8)
    assert larger is not None
    number, distance = index.nearest(larger)
    assert number == 0
    assert distance < index.distances(larger)[1]


def test_a_drawing_of_the_index_has_no_distance_and_proportions_count() -> None:
    index = Likeness([FOUR, ("#",), ("#", "#", "#", "#")], RANDOM)
    assert index.distances(FOUR)[0] < 1e-2
    assert index.nearest(("#", "#", "#"))[0] == 2
    assert index.nearest(("##", "##"))[0] == 1


def test_variants_of_a_class_could_be_one_and_most_random_drawings_could_not() -> None:
    task, _ = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
    random = np.random.default_rng(2)
    likeness, drawn = index_of([shape.rows for shape in task.shapes], task.variants, 200, random)
    assert len(drawn) > 100
    assert 0 < likeness.close < likeness.far
    assert all(likeness.could_be_one(variant.rows, True) for variant in drawn)
    strangers = [grown(random, 30, 10, 8) for _ in range(100)]
    assert sum(likeness.could_be_one(rows, False) for rows in strangers) < 20


def test_a_few_drawings_have_fixed_limits() -> None:
    likeness, drawn = index_of([FOUR, ZERO], None, 100, RANDOM)
    assert drawn == []
    assert (likeness.close, likeness.far) == (FEW_CLOSE, FEW_FAR)
