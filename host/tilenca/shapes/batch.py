"""The drawings of one or more shape files as arrays, for training and simulation.

Only real tiles are computed. A batch of any drawings is one flat list of cells with a table of neighbours in
which "no neighbour" is an index one past the last cell, where callers keep a row of zeros. numpy only.
"""

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.shapes.file import Shape, Task, load_task
from tilenca.shapes.sizes import Sizes
from tilenca.shapes.skeleton import of_rows
from tilenca.shapes.stretch import Rows
from tilenca.shapes.trainable import extent, refuse_collisions, refuse_large_sizes, trainable
from tilenca.shapes.variant import Variants

Indices = NDArray[np.int64]
MOST_STROKES = 250  # of a drawing whose strokes may be varied
UNLABELLED, NO_CLASS = "", -1  # drawings whose tiles must agree on any class


@dataclass(frozen=True)
class Batch:
    """A flat batch of drawings, one after the other.

    Attributes:
        neighbours: (N, 4) int64, indices of the N, E, S, W neighbour among the batch's cells, N for none.
        sample: (N,) int64, which drawing of the batch a cell belongs to, ascending.
        target: (N,) int64, class of the cell's drawing.
        place: (N,) int64, the cell's number within its drawing.
        starts: (B,) int64, index of each drawing's first cell.
    """

    neighbours: Indices
    sample: Indices
    target: Indices
    place: Indices
    starts: Indices


@dataclass(frozen=True, eq=False)
class Drawings:
    """All drawings of a task, from one or more files.

    Attributes:
        shapes: the drawings in the order of the files.
        groups: for each drawing the number of the file it came from, or in training of its scale.
        labels: the classes; class k is `labels[k]`.
        sources: `{"file", "sha256"}` of every file.
        variants: draws what the classes may become; None: the drawings are all there is.
    """

    shapes: tuple[Shape, ...]
    groups: tuple[int, ...]
    labels: tuple[str, ...]
    sources: tuple[dict[str, str], ...]
    variants: Variants | None = None

    def __len__(self) -> int:
        return len(self.shapes)

    @cached_property
    def sizes(self) -> Indices:
        """(S,) number of tiles of each drawing."""
        return np.array([len(shape.cells) for shape in self.shapes], dtype=np.int64)

    @property
    def largest(self) -> tuple[int, int]:
        """Most rows and most columns of the first file's drawings."""
        first = [shape.rows for shape in self.group(0)]
        return max(map(len, first)), max(len(rows[0]) for rows in first)

    def group(self, number: int) -> list[Shape]:
        """The drawings of one group, in their order."""
        return [shape for shape, group in zip(self.shapes, self.groups, strict=True) if group == number]

    @cached_property
    def classes(self) -> Indices:
        """(S,) class of each drawing; `NO_CLASS` for unlabelled ones."""
        numbers = {label: number for number, label in enumerate(self.labels)} | {UNLABELLED: NO_CLASS}
        return np.array([numbers[shape.label] for shape in self.shapes], dtype=np.int64)

    @cached_property
    def extents(self) -> Indices:
        """(S, 2) rows and columns of each drawing."""
        return np.array([(len(shape.rows), len(shape.rows[0])) for shape in self.shapes], dtype=np.int64)

    @cached_property
    def tables(self) -> NDArray[np.int16]:
        """(S, M, 4) neighbour of each cell within its drawing, -1 for none; M is the largest size."""
        tables = np.full((len(self), int(self.sizes.max()), len(SIDES)), -1, dtype=np.int16)
        for number, shape in enumerate(self.shapes):
            tables[number, : self.sizes[number]] = shape.neighbours()
        return tables

    def replaced(self, numbers: Sequence[int], shapes: Sequence[Shape]) -> "Drawings":
        """The same with other drawings in some places.

        Args:
            numbers: (K,) the places.
            shapes: K drawings.
        """
        every = list(self.shapes)
        for number, shape in zip(numbers, shapes, strict=True):
            every[number] = shape
        new, other = replace(self, shapes=tuple(every)), self.of(shapes)
        places = np.asarray(numbers, np.int64)
        most = max(self.tables.shape[1], other.tables.shape[1])
        tables = np.full((len(self), most, len(SIDES)), -1, np.int16)
        tables[:, : self.tables.shape[1]] = self.tables
        tables[places] = -1
        tables[places, : other.tables.shape[1]] = other.tables
        # What is cached of the others stays.
        new.__dict__["tables"] = tables
        for name in ("sizes", "classes", "extents"):
            values = getattr(self, name).copy()
            values[places] = getattr(other, name)
            new.__dict__[name] = values
        return new

    def chosen(self, numbers: Iterable[int]) -> "Drawings":
        """Some of these drawings, in a group of their own."""
        return self.of([self.shapes[number] for number in numbers])

    def of(self, shapes: Sequence[Shape]) -> "Drawings":
        """Other drawings of the same classes, in one group."""
        return replace(self, shapes=tuple(shapes), groups=(0,) * len(shapes))

    def batch(self, chosen: Indices) -> Batch:
        """Lays drawings out as one flat list of cells.

        Args:
            chosen: (B,) numbers of drawings, repeats allowed.
        """
        sizes = self.sizes[chosen]
        starts = np.concatenate(([0], np.cumsum(sizes)[:-1]))
        sample = np.repeat(np.arange(len(chosen)), sizes)
        place = np.arange(int(sizes.sum())) - starts[sample]
        inside = self.tables[chosen[sample], place]
        neighbours = np.where(inside >= 0, inside + starts[sample][:, None], len(sample))
        return Batch(neighbours, sample, self.classes[chosen][sample], place, starts)

    def overlap(self, old: int, new: int, random: np.random.Generator) -> Indices:
        """The tiles of `old` that the tiles of drawing `new` stand on, when one is rebuilt into the other.

        The two are laid on each other so that the smaller bounding box lies inside the larger, at a random
        place (a narrow "1" may stand on any column of a "4").

        Returns:
            (cells of new,) int64, index of the cell of `old` at the same place, -1 for a tile put down anew.
        """
        return self._overlap(old, new, *self.place_on(old, new, random))

    def place_on(self, old: int, new: int, random: np.random.Generator) -> tuple[int, int]:
        """Rows and columns by which `new` is shifted when it is laid on `old` as `overlap` does."""
        down, right = (
            int(random.integers(min(room, 0), max(room, 0) + 1))
            for room in self.extents[old] - self.extents[new]
        )
        return down, right

    def _overlap(self, old: int, new: int, down: int, right: int) -> Indices:
        index = {cell: place for place, cell in enumerate(self.shapes[old].cells)}
        cells = self.shapes[new].cells
        return np.array([index.get((row + down, col + right), -1) for row, col in cells], dtype=np.int64)


def load_drawings(
    paths: Sequence[Path], max_classes: int | None = None, labels: Sequence[str] | None = None
) -> Drawings:
    """Reads shape files that form one task together, by label.

    Args:
        paths: the files; each holds drawings of one scale.
        max_classes: how many classes the model's state has room for; None: not checked.
        labels: a model's classes, to use as the task's; None: the labels in order of first appearance.

    Raises:
        UsageError: a file is not valid, two files contradict each other, or a label is not among `labels`.
    """
    return _join(paths, (load_task(path, max_classes) for path in paths), max_classes, labels)


def _join(
    paths: Sequence[Path], tasks: Iterable[Task], max_classes: int | None, labels: Sequence[str] | None
) -> Drawings:
    """`load_drawings` of tasks; each task is taken only at its file's turn, so that errors come in order."""
    shapes: dict[Rows, tuple[Shape, int]] = {}
    found: dict[str, None] = {}
    coming = iter(tasks)
    for group, path in enumerate(paths):
        if any(path.name == other.name and path.resolve() != other.resolve() for other in paths[:group]):
            raise UsageError(
                f"{path}: another file has that name too, and tables name files by it; rename one"
            )
        for shape in next(coming).shapes:
            # The same drawing of the same label in two files is one drawing.
            twin, of = shapes.setdefault(shape.rows, (shape, group))
            if twin.label != shape.label:
                raise UsageError(
                    f"{path}: '{shape.name}' is drawn exactly like '{twin.name}' of "
                    f"{paths[of]}; remove or redraw one"
                )
            if labels is not None and shape.label not in labels:
                raise UsageError(
                    f"{path}: the model does not know '{shape.label}'; it knows: {' '.join(labels)}; "
                    "give the file it was trained on with --shapes, or train one on this file"
                )
            found.setdefault(shape.label)
        if all(of != group for _, of in shapes.values()):
            raise UsageError(f"{path}: the files before it have all of its drawings; leave it out")
        if max_classes is not None and len(found) > max_classes:
            raise UsageError(
                f"{path}: {len(found)} classes in all files, but the model's state has room for "
                f"{max_classes}; give fewer files or train with a wider --state"
            )
    sources = tuple(
        {"file": path.name, "sha256": hashlib.sha256(path.read_bytes()).hexdigest()} for path in paths
    )
    every, groups = zip(*shapes.values(), strict=True)
    return Drawings(every, groups, tuple(found) if labels is None else tuple(labels), sources)


def load_training_task(
    paths: Sequence[Path], stretch: float, max_classes: int, labels: Sequence[str] | None = None
) -> tuple[Drawings, Sizes]:
    """The drawings to train on, and the task's sizes.

    Args:
        paths: the files; the first may say that its drawings were drawn at other sizes too.
        stretch: the recipe's largest stretch factor; 1 trains on the given files alone.
        max_classes: how many classes the model's state has room for.
        labels: a model's classes, see `load_drawings`.

    Returns:
        The drawings, and the sizes; its `drawn` are the files that are not among the drawings.

    Raises:
        UsageError: as `load_drawings`.
    """
    drawn = trainable(paths[0], max_classes)
    sizes = drawn.sizes
    refuse_collisions(paths[0], drawn, sizes)
    refuse_large_sizes(paths[0], drawn, sizes, stretch)
    more = tuple(path for path in sizes.drawn if path.resolve() not in [given.resolve() for given in paths])
    if stretch > 1:
        paths, more = [*paths, *more], ()
    tasks = chain([drawn], (trainable(path, max_classes) for path in paths[1:]))
    joined = _join(paths, tasks, max_classes, labels)
    return replace(joined, variants=_variants_of(drawn)), replace(sizes, drawn=more)


def _variants_of(task: Task) -> Variants | None:
    """What the classes of a file may become; None where they are just its drawings, or a drawing is an area.

    An area has as many strokes as tiles, and a hand does not draw those one by one.
    """
    if task.vary is None:
        return None
    # The skeletons of all drawings of a file share one unit square, so that narrow ones stay narrow.
    rows, cols = extent(task)
    unit = np.maximum((cols - 1, rows - 1), 1)
    drawn = [(shape.label, of_rows(shape.rows)) for shape in task.shapes]
    if max(len(skeleton.edges) for _, skeleton in drawn) > MOST_STROKES:
        return None
    scaled = [(label, replace(skeleton, points=skeleton.points / unit)) for label, skeleton in drawn]
    return Variants([*scaled, *task.forms], task.vary.sized((rows, cols), task.sizes), task.sizes.held_out)
