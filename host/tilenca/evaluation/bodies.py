"""Cases about tiles as one body: any connected drawing must agree on one answer, also with tiles dead.

All drawings here are made by one seed; those that a model may have been trained on are among them, since the
question is not what the drawing is but whether its tiles are of one mind.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

import numpy as np

from tilenca.evaluation.cases import SHORT_STEPS, Case, steps_for
from tilenca.shapes import edits
from tilenca.shapes.batch import UNLABELLED, Drawings
from tilenca.shapes.cells import beside
from tilenca.shapes.derive import at_size
from tilenca.shapes.file import Shape
from tilenca.shapes.sizes import Size, Sizes, size_name
from tilenca.shapes.stretch import Rows

LARGER: Size = (12, 10)  # at which agreement is asked, beside the drawn size, where the task has it
EACH = 60  # drawings of each kind
DEAD = (0.05, 0.15)  # shares of dead tiles
TIMES = 2  # as many rows and columns as drawn, for dead tiles


def agreeing_cases(
    task: Drawings, first: Sequence[Shape], aimed: Sizes, seed: int, asked: bool
) -> Iterator[Case]:
    """Any connected drawings, and drawings of a class with one tile too many, at one or two sizes.

    Args:
        task: of the model.
        first: the drawings of the first file.
        aimed: the sizes that the model is trained for.
        seed: of the drawings.
        asked: whether the model is trained to agree on them.
    """
    random = np.random.default_rng(seed)
    for size in (None, LARGER) if LARGER in aimed.trained else (None,):
        shapes = list(first) if size is None else at_size(first, size)
        name, steps = size_name(size or task.largest), SHORT_STEPS if size is None else steps_for(size)
        rows = dict.fromkeys(_any_connected([shape.rows for shape in shapes], random))
        any_drawing = [Shape(UNLABELLED, drawing, "/".join(drawing)) for drawing in rows]
        if any_drawing:
            title = f"{name}, any connected drawing: one answer on all tiles"
            yield Case("one answer", title, task.of(any_drawing), steps, aimed=asked)
        more = list(_with_one_more(shapes, random))
        if more:
            title = f"{name}, one tile too many: the class or a dash, but one answer"
            yield Case("one tile too many", title, task.of(more), steps, aimed=asked)


def _any_connected(drawings: Sequence[Rows], random: np.random.Generator) -> Iterator[Rows]:
    """Grown ones, halves, other strokes, and drawings with some tiles too many or too few."""
    drawers: Sequence[Callable[[], Rows | None]] = (
        edits.some_grown(drawings, random, least=4),
        edits.some_halves(drawings, random),
        edits.some_strokes(drawings, random),
        edits.some_edited(drawings, random),
    )
    return chain.from_iterable(edits.draw_until(EACH, draw, lambda rows: True) for draw in drawers)


def _with_one_more(shapes: Sequence[Shape], random: np.random.Generator) -> Iterator[Shape]:
    """Drawings with a tile put down beside another, as many of each as make `EACH` together."""
    whole = {shape.rows for shape in shapes}
    for shape in shapes:
        spots = sorted(beside(shape.cells))
        for number in random.permutation(len(spots))[: max(1, EACH // len(shapes))]:
            rows = edits.rows_of([*shape.cells, spots[number]])
            if rows not in whole:
                yield Shape(shape.label, rows, f"{shape.name} one more")


def dead_cases(
    task: Drawings, first: Sequence[Shape], aimed: Sizes, damaged: bool, varied: bool
) -> Iterator[Case]:
    """The drawings at twice the size with dead tiles: strokes one tile thick, and two.

    Args:
        task: of the model.
        first: the drawings of the first file.
        aimed: the sizes that the model is trained for.
        damaged: whether it is trained with tiles missing.
        varied: whether it is trained with strokes of any thickness.
    """
    height, width = task.largest
    size = TIMES * height, TIMES * width
    thick = [Shape(shape.label, _thick(shape.rows), f"{shape.name} thick") for shape in first]
    for shapes, strokes, asked in (
        (at_size(first, size), "one tile", damaged and size in aimed.trained),
        (thick, "two tiles", damaged and varied),
    ):
        for dead in DEAD if shapes else ():
            name = f"{size_name(size)}, strokes {strokes} thick, {100 * dead:.0f} % of the tiles dead"
            kind = f"{100 * dead:.0f} % dead, {strokes} thick"
            yield Case(kind, name, task.of(shapes), steps_for(size), aimed=asked, dead=dead)


def _thick(rows: Rows) -> Rows:
    """Every tile as a square of `TIMES` x `TIMES`."""
    return tuple("".join(mark * TIMES for mark in row) for row in rows for _ in range(TIMES))
