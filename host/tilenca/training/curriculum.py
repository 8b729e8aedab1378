"""The drawings to train on: a task's own, stretched ones, damaged ones, and drawings of no class.

A grid is rebuilt only into drawings of its own scale; a drawing's weight is its share of the grids. The task,
the recipe and one random generator decide all of it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes import variants
from tilenca.shapes.batch import Drawings
from tilenca.shapes.derive import at_sizes, damaged, draw_unknown, known_of
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
        whole: (S,) bool, drawings of a class without damage; training begins with them.
    """

    drawings: Drawings
    weights: NDArray[np.float64]
    whole: NDArray[np.bool_]


@dataclass(frozen=True)
class UnknownKind:
    """A kind of drawings of no class.

    Attributes:
        share: of all drawings of no class.
        elsewhere: whether they are made from the drawings at other sizes, or from those of the files.
        each: how many of every scale.
        drawer: makes them.
    """

    share: float
    elsewhere: bool
    each: int
    drawer: variants.Drawer


UNKNOWN_KINDS = (
    UnknownKind(0.4, False, 100, variants.some_strokes),
    UnknownKind(0.08, False, 100, variants.some_edited),
    UnknownKind(0.17, False, 100, variants.some_halves),
    UnknownKind(0.1, False, 100, variants.some_grown),
    UnknownKind(0.22, True, 12, variants.some_strokes),
    UnknownKind(0.03, True, 3, variants.some_edited),
)


@dataclass(frozen=True)
class _Part:
    """Drawings that have a share of the grids together.

    Attributes:
        share: of the grids, 0..1.
        entries: scale and drawing.
        whole: whether they are drawings of a class without damage.
    """

    share: float
    entries: list[tuple[int, Shape]]
    whole: bool = False


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
    known = known_of(shape for scale in scales for shape in scale)
    less = damaged(scales[0], known, DAMAGED, "training") if recipe.damaged else []
    drawn = [(n, shape) for n, scale in enumerate(scales) for shape in scale if n < len(task.sources)]
    stretched = [(n, shape) for n, scale in enumerate(scales) for shape in scale if n >= len(task.sources)]
    parts = [
        _Part(recipe.stretched, stretched, whole=True),
        _Part(recipe.damaged, [(0, shape) for shape in less]),
    ]
    if recipe.unknown > 0 and UNKNOWN in task.labels:
        # A large drawing without a stroke looks like a small one without a tile.
        doubtful = {smallest(shape.rows) for shape in less}
        for kind in UNKNOWN_KINDS:
            found = list(_unknown(kind, scales, len(task.sources), known, doubtful, random))
            parts.append(_Part(recipe.unknown * kind.share, found))
    parts = [part for part in parts if part.share and part.entries]
    return _curriculum(task, [_Part(1 - sum(part.share for part in parts), drawn, whole=True), *parts])


def _curriculum(task: Drawings, parts: Sequence[_Part]) -> Curriculum:
    """The curriculum that consists of these parts."""
    entries = [entry for part in parts for entry in part.entries]
    drawings = replace(
        task,
        shapes=tuple(shape for _, shape in entries),
        groups=tuple(scale for scale, _ in entries),
    )
    weights = [np.full(len(part.entries), part.share / len(part.entries)) for part in parts]
    whole = [part.whole for part in parts for _ in part.entries]
    return Curriculum(drawings, np.concatenate(weights), np.array(whole))


def _scales(task: Drawings, sizes: Sequence[Size]) -> list[list[Shape]]:
    """The drawings file by file, then those of the first file at every other size."""
    scales = [task.group(number) for number in range(len(task.sources))]
    taken: dict[Rows, str] = {shape.rows: shape.label for shape in task.shapes}
    for shapes in at_sizes(scales[0], sizes):
        scale = [shape for shape in shapes if taken.setdefault(shape.rows, shape.label) == shape.label]
        if scale and scale != scales[-1]:
            scales.append(scale)
    return scales


def _unknown(
    kind: UnknownKind,
    scales: Sequence[Sequence[Shape]],
    files: int,
    known: Known,
    doubtful: set[Rows],
    random: np.random.Generator,
) -> Iterator[tuple[int, Shape]]:
    """Drawings of no class, with their scales.

    Args:
        kind: how they are made.
        scales: the drawings of each scale.
        files: how many scales are those of the files, which come first.
        known: the index of all drawings of a class.
        doubtful: the smallest forms of damaged drawings, which may not recur at any size.
        random: the only source of chance.
    """
    for number in range(files, len(scales)) if kind.elsewhere else range(files):
        draw = kind.drawer([shape.rows for shape in scales[number]], random)
        for rows in draw_unknown(kind.each, draw, known, "training", doubtful):
            yield number, Shape(UNKNOWN, rows, f"none of {len(rows)}x{len(rows[0])}")
