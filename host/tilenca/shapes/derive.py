"""Shapes derived from a task's shapes: at other sizes, damaged, and drawings of no class.

Training and test suites derive them alike; `variant.split_of` keeps their forms apart.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

from tilenca.shapes import edits
from tilenca.shapes.edits import Known
from tilenca.shapes.file import Shape
from tilenca.shapes.sizes import Size
from tilenca.shapes.stretch import Rows, smallest
from tilenca.shapes.variant import split_of


def known_of(shapes: Iterable[Shape]) -> Known:
    """The index of a task's shapes."""
    return Known((shape.label, shape.rows) for shape in shapes)


def at_size(shapes: Iterable[Shape], size: Size, up: bool = True) -> list[Shape]:
    """The shapes at another size, without those that cannot be drawn that small.

    Args:
        shapes: the shapes.
        size: rows and columns.
        up: where a row or column would come to lie half-way between two places, take the later one.
    """
    return [other for shape in shapes if (other := shape.stretched(size, up)) is not None]


def at_sizes(shapes: Sequence[Shape], sizes: Iterable[Size]) -> Iterator[list[Shape]]:
    """The shapes at every size, half-way places first rounded up, then down."""
    for size in sizes:
        for up in (True, False):
            yield at_size(shapes, size, up)


def damaged(shapes: Iterable[Shape], known: Known, suffix: str, split: str) -> list[Shape]:
    """The shapes with one tile missing, where that leaves no doubt about the class.

    Args:
        shapes: shapes of the task.
        known: the index of all its shapes.
        suffix: of their names.
        split: only those on this side of the split (`variant.split_of`).
    """
    return [
        Shape(shape.label, rows, f"{shape.name}{suffix}")
        for shape in shapes
        for rows in known.damaged(shape.label, shape.rows)
        if split_of(rows) == split
    ]


def draw_unknown(
    wanted: int,
    draw: Callable[[], Rows | None],
    known: Known,
    split: str,
    doubtful: Collection[Rows] = (),
) -> list[Rows]:
    """Draws different drawings of no class; fewer than `wanted` where hardly a new one turns up.

    Args:
        wanted: how many.
        draw: the source of drawings, see `edits.Drawer`.
        known: the index of the task's shapes, which are excluded with all that look like them.
        split: draw only those on this side of the split (`variant.split_of`).
        doubtful: the smallest forms of other drawings to exclude, at every size.
    """

    def fits(rows: Rows) -> bool:
        return split_of(rows) == split and not known.is_known(rows) and smallest(rows) not in doubtful

    return edits.draw_until(wanted, draw, fits)
