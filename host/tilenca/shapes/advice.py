"""What to know of a shape file before a training: what tiles can show, and what is easily taken for what."""

from collections.abc import Iterator, Sequence

import numpy as np

from tilenca.shapes.file import Shape, Task
from tilenca.shapes.sizes import size_name
from tilenca.shapes.stretch import Rows

# A 7-segment digit only hints at these; beside each, what it looks like.
HINTS = {"K": "", "M": "", "V": "", "W": "", "X": "H", "Z": "2", "G": "C", "S": "5", "I": "1"}
CLEAR = "A b C d E F H L P t U"
MOST = 60  # drawings that are compared with each other


def advice(task: Task) -> Iterator[str]:
    """Sentences about labels, drawings that are alike, and sizes, in this order."""
    yield from _labels(task.labels)
    if len(task.shapes) <= MOST:
        yield from _alike(task.shapes)
    if sizes := task.sizes.trained:
        least, largest = size_name(min(sizes)), size_name(max(sizes))
        yield f"other sizes: the file says that the classes keep their meaning from {least} to {largest}"
    else:
        yield "other sizes: the file has no [sizes], so training decides how far drawings may be stretched"


def _labels(labels: Sequence[str]) -> Iterator[str]:
    hinted = [
        f"{label} (looks like {HINTS[label]})" if HINTS[label] else label
        for label in labels
        if label in HINTS
    ]
    if hinted:
        yield f"a 7-segment digit can only hint at {', '.join(hinted)}; clear are {CLEAR} and digits"


def _alike(shapes: Sequence[Shape]) -> Iterator[str]:
    """Pairs that differ by a tile, and drawings that are a part of others, in any place."""
    apart: list[str] = []
    parts: dict[str, list[str]] = {}
    for number, one in enumerate(shapes):
        for other in shapes[number + 1 :]:
            if one.label == other.label:
                continue
            less, more = sorted((one, other), key=lambda shape: len(shape.cells))
            shared = overlap(less.rows, more.rows)
            differing = len(less.cells) + len(more.cells) - 2 * shared
            if differing <= 1:
                apart.append(f"{less.name} and {more.name}")
            elif shared == len(less.cells):
                parts.setdefault(less.name, []).append(more.name)
    if apart:
        yield (
            f"one tile makes the difference between {', '.join(apart)}: where it is missing, or too many, "
            "tiles cannot know which is meant"
        )
    if parts:
        listed = "; ".join(f"{name} of {' '.join(whole)}" for name, whole in parts.items())
        yield f"a part of others, which tiles may show while they are put together: {listed}"


def overlap(one: Rows, other: Rows) -> int:
    """The most tiles that two drawings share, wherever one is laid upon the other."""
    first, second = (
        np.array([[mark == "#" for mark in row] for row in rows], float) for rows in (one, other)
    )
    height, width = (a + b for a, b in zip(first.shape, second.shape, strict=True))
    turned = np.fft.rfft2(first[::-1, ::-1], (height, width))
    return round(float(np.fft.irfft2(turned * np.fft.rfft2(second, (height, width)), (height, width)).max()))
