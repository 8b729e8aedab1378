"""Whether the drawings of a task can be trained: not too large for ids, and different at every size."""

from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.shapes.file import MAX_TILES, Shape, Task, load_task, too_large
from tilenca.shapes.sizes import Sizes, size_name


def trainable(path: Path, max_classes: int) -> Task:
    """The task of a file whose drawings can all be laid out.

    Raises:
        UsageError: the file is not valid, or a drawing has more tiles than there are ids.
    """
    task = load_task(path, max_classes)
    if (remedy := too_large(task.shapes)) is not None:
        raise UsageError(f"{path}: {remedy}")
    return task


def refuse_large_sizes(path: Path, task: Task, sizes: Sizes, factor: float) -> None:
    """Refuses sizes to train on, up to a factor, at which a drawing has more tiles than there are ids.

    Raises:
        UsageError: there is such a size; the message names the file, the drawing and the size.
    """
    fitting = sizes.within(extent(task), factor)
    for size in (*fitting.trained, *fitting.more):
        for shape in task.shapes:
            other = shape.stretched(size)
            if other is not None and (tiles := len(other.cells)) > MAX_TILES:
                raise UsageError(
                    f"{path}: [sizes] '{shape.name}' has {tiles} tiles at {size_name(size)}; "
                    f"the most that ids allow are {MAX_TILES}, so end at a smaller size"
                )


def refuse_collisions(path: Path, task: Task, sizes: Sizes) -> None:
    """Refuses sizes at which two classes are one drawing, and a held-out size that is nevertheless drawn.

    Raises:
        UsageError: there is such a size; the message names the file and the size.
    """
    for size in (*sizes.trained, *sizes.more, *sizes.held_out):
        seen: dict[tuple[str, ...], Shape] = {}
        for shape in task.shapes:
            for up in (True, False):
                other = shape.stretched(size, up)
                if other is None:
                    continue
                twin = seen.setdefault(other.rows, other)
                if twin.label != other.label:
                    raise UsageError(
                        f"{path}: [sizes] '{twin.label}' and '{other.label}' are the same drawing at "
                        f"{size_name(size)}; leave that size out, or redraw one of them"
                    )
    if (largest := extent(task)) in sizes.held_out:
        raise UsageError(f"{path}: [sizes] holds out {size_name(largest)}, which the shapes are drawn at")


def extent(task: Task) -> tuple[int, int]:
    """Most rows and most columns of a task's drawings."""
    return max(len(s.rows) for s in task.shapes), max(len(s.rows[0]) for s in task.shapes)
