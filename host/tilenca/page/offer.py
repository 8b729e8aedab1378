"""What the page offers to lay out: the drawings of shape files, and the labels of their classes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.shipped import shapes_file
from tilenca.shapes.file import Shape, load_task

# The digits at all the sizes that are drawn by hand.
DEFAULT_SHAPES = ("digits", "digits-3x3", "digits-7x6")


@dataclass(frozen=True)
class Drawing:
    """A shape that the page offers; `name` is unique among them, such as `digits-3x3/4`."""

    name: str
    shape: Shape


@dataclass(frozen=True)
class Offer:
    """All of them, and the labels of the classes, each once, in the order of the files."""

    labels: tuple[str, ...]
    drawings: tuple[Drawing, ...]


def load_offer(files: Sequence[Path] = ()) -> Offer:
    """Reads shape files; without any, those of the digits.

    Raises:
        UsageError: one cannot be read, or is not a valid task.
    """
    tasks = [load_task(path) for path in files or map(shapes_file, DEFAULT_SHAPES)]
    return Offer(
        labels=tuple(dict.fromkeys(label for task in tasks for label in task.labels)),
        drawings=tuple(
            Drawing(f"{task.path.stem}/{shape.name}", shape) for task in tasks for shape in task.shapes
        ),
    )
