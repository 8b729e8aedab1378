"""The drawings to train on: a task's own, at other sizes, and many that are drawn by chance and renewed.

The files' drawings and the stretched ones stay. The others (`training.generator`) fill the places that the
recipe's `library` gives them, and are replaced again and again, so that training sees thousands of drawings.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import SIDES
from tilenca.shapes.batch import Drawings
from tilenca.shapes.derive import at_sizes
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.gaps import Gaps
from tilenca.shapes.sizes import Size, Sizes
from tilenca.shapes.stretch import Rows
from tilenca.training.generator import DAMAGED, FREE, OF_NO_CLASS, VARIED, Generator
from tilenca.training.recipe import Recipe

DRAWN, STRETCHED = "drawn", "stretched"
WHOLE = (DRAWN, STRETCHED, VARIED)


@dataclass(frozen=True)
class Curriculum:
    """Drawings to train on.

    Attributes:
        drawings: all of them.
        kinds: (S,) the kind of each.
        weights: (S,) float64, share of the grids that a drawing gets; sums to 1.
        failing: (S,) int64, the record of failures that a drawing belongs to: of its own, or of its kind and
            class where it is renewed.
        generator: draws the ones that are renewed; None: none is.
        gaps: knows where tiles are missing; None: the network does not learn to say it.
    """

    drawings: Drawings
    kinds: NDArray[np.str_]
    weights: NDArray[np.float64]
    failing: NDArray[np.int64]
    generator: Generator | None = None
    gaps: Gaps | None = None

    @cached_property
    def _whole_one(self) -> NDArray[np.int64]:
        """(S,) the whole drawing that a drawing is with one tile missing, -1 for none or a doubt."""
        if self.gaps is None:
            return np.full(len(self.kinds), -1)
        numbers = {shape.rows: n for n, shape in enumerate(self.drawings.shapes) if not self.renewable[n]}
        found = [self.gaps.missing(shape) for shape in self.drawings.shapes]
        return np.array([-1 if one is None else numbers[one[0]] for one in found])

    def missing(self, chosen: NDArray[np.int64]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """The sides of the cells of some drawings on which a tile is missing, and where that is known.

        Args:
            chosen: (B,) drawings, of N cells.

        Returns:
            (N, 4) bool, and (N,) bool.
        """
        assert self.gaps is not None
        shapes = [self.drawings.shapes[number] for number in chosen]
        sides = [self.gaps.sides(shape) for shape in shapes]
        sizes = self.drawings.sizes[chosen]
        empty = [np.zeros((size, len(SIDES)), np.bool_) for size in sizes]
        told = np.array([one is not None for one in sides])
        missing = [none if one is None else one for one, none in zip(sides, empty, strict=True)]
        return np.concatenate(missing), np.repeat(told, sizes)

    def with_one_tile_changed(self, drawing: int) -> NDArray[np.int64]:
        """The drawings that have one tile less than a whole one, or the whole one that lacks a tile."""
        whole = self._whole_one[drawing]
        return np.flatnonzero(self._whole_one == drawing) if whole < 0 else np.array([whole])

    @property
    def whole(self) -> NDArray[np.bool_]:
        """(S,) drawings of a class without damage."""
        whole: NDArray[np.bool_] = np.isin(self.kinds, WHOLE)
        return whole

    @property
    def renewable(self) -> NDArray[np.bool_]:
        """(S,) drawings that are renewed."""
        renewable: NDArray[np.bool_] = ~np.isin(self.kinds, (DRAWN, STRETCHED))
        return renewable

    @property
    def records(self) -> int:
        """How many records of failures there are, those of drawings to come included."""
        return int((~self.renewable).sum()) + len(np.unique(self.kinds)) * (len(self.drawings.labels) + 1)

    @property
    def most_tiles(self) -> int:
        """The most tiles of any drawing, those of drawings to come included."""
        largest = int(self.drawings.sizes.max())
        return largest if self.generator is None else max(largest, self.generator.most_tiles)

    def renewed(self, places: NDArray[np.int64], random: np.random.Generator) -> "Curriculum":
        """The curriculum with new drawings in some places, which are renewable."""
        if self.generator is None:
            return self
        return self.with_drawings(
            places, [self.generator.draw(self.kinds[place], random) for place in places]
        )

    def with_drawings(self, places: NDArray[np.int64], shapes: Sequence[Shape]) -> "Curriculum":
        """The curriculum with these drawings in some places."""
        if not len(places):
            return self
        drawings = self.drawings.replaced(places.tolist(), shapes)
        return replace(self, drawings=drawings, failing=_failing(drawings, self.kinds))


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
        random: for the drawings that are drawn by chance.
    """
    if recipe.varied == 0:
        task = replace(task, variants=None)
    fitting = sizes.within(task.largest, recipe.stretch)
    drawn, stretched = list(task.shapes), list(_stretched(task, fitting.trained + fitting.more))
    shares = {
        STRETCHED: recipe.stretched if stretched else 0.0,
        VARIED: recipe.varied if task.variants else 0.0,
        DAMAGED: recipe.damaged,
        OF_NO_CLASS: recipe.unknown if UNKNOWN in task.labels else 0.0,
        FREE: recipe.unlabelled,
    }
    shares = {DRAWN: 1 - sum(shares.values()), **shares}
    entries = [(DRAWN, shape) for shape in drawn] + [
        (STRETCHED, shape) for shape in stretched if shares[STRETCHED]
    ]
    gaps = Gaps(shape for _, shape in entries) if recipe.directions else None
    renewed = {kind: share for kind, share in shares.items() if kind not in (DRAWN, STRETCHED) and share}
    generator = None
    if renewed:
        generator = Generator(
            task,
            [shape for _, shape in entries],
            tuple(renewed),
            recipe.library // 5,
            random,
            gaps is not None,
        )
        for kind, share in renewed.items():
            count = max(len(task.labels), round(recipe.library * share / sum(renewed.values())))
            entries += [(kind, generator.draw(kind, random)) for _ in range(count)]
    kinds = np.array([kind for kind, _ in entries])
    drawings = replace(task, shapes=tuple(shape for _, shape in entries), groups=(0,) * len(entries))
    counts = {kind: int((kinds == kind).sum()) for kind in shares}
    weights = np.array([shares[kind] / counts[kind] for kind, _ in entries])
    return Curriculum(drawings, kinds, weights, _failing(drawings, kinds), generator, gaps)


def _stretched(task: Drawings, sizes: Sequence[Size]) -> Iterator[Shape]:
    """The drawings of the first file at other sizes, without those that another class has too."""
    taken: dict[Rows, str] = {shape.rows: shape.label for shape in task.shapes}
    for shapes in at_sizes(task.group(0), sizes):
        for shape in shapes:
            if shape.rows not in taken:
                taken[shape.rows] = shape.label
                yield shape


def _failing(drawings: Drawings, kinds: NDArray[np.str_]) -> NDArray[np.int64]:
    """(S,) records of failures: own ones of what stays, those of kind and class of what is renewed."""
    stays = np.isin(kinds, (DRAWN, STRETCHED))
    _, number = np.unique(kinds, return_inverse=True)
    shared = int(stays.sum()) + number * (len(drawings.labels) + 1) + drawings.classes + 1
    failing: NDArray[np.int64] = np.where(stays, np.cumsum(stays) - 1, shared)
    return failing
