"""Variants of a task's classes: within their limits, by seed, and split by form."""

from dataclasses import replace

import numpy as np

from tilenca.base import paths
from tilenca.shapes.batch import load_training_task
from tilenca.shapes.cells import cells_of, connected
from tilenca.shapes.form import make_form
from tilenca.shapes.raster import holes
from tilenca.shapes.skeleton import of_rows
from tilenca.shapes.stretch import smallest
from tilenca.shapes.variant import CHOOSING, LAST, TRAINED, Variant, Variants

TASK, _ = load_training_task([paths.DEFAULT_SHAPES], 10.0, 20)
assert TASK.variants is not None
VARIANTS: Variants = TASK.variants


def some(seed: int, count: int, split: str = TRAINED) -> list[Variant]:
    random = np.random.default_rng(seed)
    drawn = (VARIANTS.draw(label, split, random) for _ in range(count) for label in "0123456789")
    return [variant for variant in drawn if variant is not None]


def test_variants_keep_to_the_limits_and_never_have_a_size_that_is_held_out() -> None:
    drawn = some(1, 60)
    extents = {(len(variant.rows), len(variant.rows[0])) for variant in drawn}
    assert max(rows for rows, _ in extents) <= VARIANTS.most[0]
    assert max(cols for _, cols in extents) <= VARIANTS.most[1]
    assert not extents & {(8, 5), (9, 7), (11, 9), (13, 10), (14, 12)}
    assert {variant.thickness for variant in drawn} == {1, 2, 3}
    assert all(connected(cells_of(variant.rows)) for variant in drawn)
    assert len({variant.rows for variant in drawn}) > 0.95 * len(drawn)


def test_digits_keep_their_holes() -> None:
    allowed = {"0": {1}, "1": {0}, "2": {0}, "3": {0}, "4": {0, 1}, "5": {0}, "6": {1}, "8": {2}, "9": {1}}
    for variant in some(2, 40):
        grid = np.array([[mark == "#" for mark in row] for row in variant.rows])
        # A "7" may have a bar, but no hole.
        assert holes(grid) in allowed.get(variant.label, {0}), "\n".join(variant.rows)


def test_the_same_seed_draws_the_same() -> None:
    assert some(3, 5) == some(3, 5)
    assert some(3, 5) != some(4, 5)


def test_the_sides_of_the_split_share_no_drawing_at_any_size() -> None:
    trained, choosing, last = (
        {smallest(variant.rows) for variant in some(5, 150, split)} for split in (TRAINED, CHOOSING, LAST)
    )
    assert len(trained) > 500
    assert len(choosing) > 15
    assert len(last) > 15
    assert not trained & (choosing | last)
    assert not choosing & last


def test_a_held_out_form_is_never_trained_at_any_size_or_thickness() -> None:
    random = np.random.default_rng(6)
    for label, skeleton in VARIANTS.skeletons:
        key = make_form(skeleton, VARIANTS.vary, random).key()
        assert isinstance(key, int), label
    # The key decides before a size is drawn: with the same numbers one side gets it, and never both.
    for seed in range(300):
        drawn = [
            VARIANTS.draw("5", split, np.random.default_rng(seed)) is not None
            for split in (TRAINED, CHOOSING, LAST)
        ]
        assert sum(drawn) <= 1


def test_a_task_may_have_one_drawing_only() -> None:
    alone = Variants([pair for pair in VARIANTS.skeletons if pair[0] == "7"][:1], replace(VARIANTS.vary))
    assert alone.labels == ("7",)
    random = np.random.default_rng(1)
    assert any(alone.draw("7", TRAINED, random) for _ in range(20))


def test_a_single_tile_has_no_variants() -> None:
    random = np.random.default_rng(1)
    single = Variants([("0", of_rows(("#",)))], VARIANTS.vary)
    assert not any(single.draw("0", TRAINED, random) for _ in range(20))


def test_a_line_never_becomes_a_block() -> None:
    for variant in some(7, 200):
        rows, cols = len(variant.rows), len(variant.rows[0])
        if variant.label == "1" and all("." not in row for row in variant.rows):
            assert rows >= 4 * cols
