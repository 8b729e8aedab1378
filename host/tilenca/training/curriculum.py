"""The drawings to train on: a task's own, the same stretched, damaged, and drawings of no class.

Every drawing has a scale, within which grids are rebuilt into each other, and a weight, its share of the
grids. Task, recipe and one random generator decide all of it.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes import variants
from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.sizes import Size, Sizes
from tilenca.shapes.stretch import Rows, smallest
from tilenca.shapes.variants import Known
from tilenca.training.recipes import Recipe

DAMAGED = " damaged"


@dataclass(frozen=True)
class Curriculum:
    """Drawings to train on.

    Attributes:
        drawings: all of them; `groups` are scales.
        weights: (S,) float64, share of the grids that a drawing gets; sums to 1.
        whole: (S,) bool, drawings of a class without damage: with which training begins.
    """

    drawings: Drawings
    weights: NDArray[np.float64]
    whole: NDArray[np.bool_]


def labels_of(task: Drawings, recipe: Recipe, max_classes: int) -> tuple[str, ...]:
    """The classes to train: the task's, and a dash for all other drawings where the state has room."""
    if recipe.unknown == 0 or UNKNOWN in task.labels or len(task.labels) == max_classes:
        return task.labels
    return (*task.labels, UNKNOWN)


def build(task: Drawings, recipe: Recipe, sizes: Sizes, random: np.random.Generator) -> Curriculum:
    """Makes the curriculum of a task.

    Args:
        task: the drawings of the files, with the model's labels.
        recipe: the shares.
        sizes: other sizes to stretch the drawings of the first file to.
        random: for the drawings of no class.
    """
    fitting = sizes.within(task.largest, recipe.stretch)
    scales = _scales(task, fitting.trained + fitting.more)
    known = Known((shape.label, shape.rows) for scale in scales for shape in scale)
    damaged = list(_damaged(scales[:1], known)) if recipe.damaged else []
    # A stroke missing from a large drawing looks, larger, like one tile missing from a small one.
    doubtful = {smallest(shape.rows) for _, shape in damaged}
    drawn = len(task.sources)
    drawn_scales, others = range(drawn), range(drawn, len(scales))
    with_unknown = recipe.unknown > 0 and UNKNOWN in task.labels
    unknown = {
        name: list(_unknown(scales, which, each, draw, known, doubtful, random)) if with_unknown else []
        for name, which, each, draw in (
            ("strokes", drawn_scales, 100, variants.some_strokes),
            ("edited", drawn_scales, 100, variants.some_edited),
            ("halves", drawn_scales, 100, variants.some_halves),
            ("grown", drawn_scales, 100, variants.some_grown),
            ("elsewhere", others, 12, variants.some_strokes),
            ("elsewhere edited", others, 3, variants.some_edited),
        )
    }
    shares = {
        "strokes": 0.4,
        "edited": 0.08,
        "halves": 0.17,
        "grown": 0.1,
        "elsewhere": 0.22,
        "elsewhere edited": 0.03,
    }
    kinds: list[tuple[float, list[tuple[int, Shape]], bool]] = [
        (recipe.stretched, [(n, s) for n, scale in enumerate(scales) if n >= drawn for s in scale], True),
        (recipe.damaged, damaged, False),
        *((recipe.unknown * shares[name], found, False) for name, found in unknown.items()),
    ]
    kinds = [kind for kind in kinds if kind[0] and kind[1]]
    own = [(number, shape) for number, scale in enumerate(scales[:drawn]) for shape in scale]
    kinds.insert(0, (1 - sum(kind[0] for kind in kinds), own, True))
    entries = [entry for _, found, _ in kinds for entry in found]
    is_whole = [whole for _, found, whole in kinds for _ in found]
    weights = np.concatenate([np.full(len(found), share / len(found)) for share, found, _ in kinds])
    drawings = replace(
        task,
        shapes=tuple(shape for _, shape in entries),
        groups=tuple(scale for scale, _ in entries),
    )
    return Curriculum(drawings, weights, np.array(is_whole))


def _scales(task: Drawings, sizes: Sequence[Size]) -> list[list[Shape]]:
    """The drawings file by file, then those of the first file at every other size."""
    files = [task.group(number) for number in range(len(task.sources))]
    taken: dict[Rows, str] = {shape.rows: shape.label for shape in task.shapes}
    scales = list(files)
    for size in sizes:
        for up in (True, False):
            scale = []
            for shape in files[0]:
                other = shape.stretched(size, up)
                if other is not None and taken.setdefault(other.rows, shape.label) == shape.label:
                    scale.append(other)
            if scale and scale != scales[-1]:
                scales.append(scale)
    return scales


def _damaged(scales: list[list[Shape]], known: Known) -> Iterator[tuple[int, Shape]]:
    for number, scale in enumerate(scales):
        for shape in scale:
            for rows in known.damaged(shape.label, shape.rows):
                yield number, Shape(shape.label, rows, f"{shape.name}{DAMAGED}")


def _unknown(
    scales: list[list[Shape]],
    which: Iterable[int],
    each: int,
    drawer: variants.Drawer,
    known: Known,
    doubtful: set[Rows],
    random: np.random.Generator,
) -> Iterator[tuple[int, Shape]]:
    """Drawings of no class, of every scale in `which`; none that is a doubtful one at another size."""

    def fits(rows: Rows) -> bool:
        return not (variants.held_out(rows) or known.is_known(rows) or smallest(rows) in doubtful)

    for number in which:
        draw = drawer([shape.rows for shape in scales[number]], random)
        for rows in variants.draw_until(each, draw, fits):
            yield number, Shape(UNKNOWN, rows, f"none of {len(rows)}x{len(rows[0])}")
