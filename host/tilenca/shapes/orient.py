"""Drawings turned and mirrored: the key `orientations` of a shape file.

orientations = "turned"   # a drawing keeps its class when it is turned by 90, 180 or 270 degrees
orientations = "all"      # and when it is mirrored, too
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from tilenca.base.errors import UsageError
from tilenca.shapes.skeleton import Skeleton
from tilenca.shapes.stretch import Rows

KINDS = "turned", "all"


def read_orientations(path: Path, value: object) -> str | None:
    """Checks the key of a shape file.

    Raises:
        UsageError: it is no kind of orientations.
    """
    if value is not None and value not in KINDS:
        raise UsageError(f'{path}: orientations {value!r}; write "turned" or "all", or leave it out')
    return None if value is None else str(value)


def orientations(rows: Rows, kind: str | None) -> list[Rows]:
    """A drawing and its other orientations, each once, as it is drawn first."""
    found = []
    for start in (rows, _mirrored(rows)) if kind == "all" else (rows,):
        turned = start
        for _ in range(4 if kind else 1):
            found.append(turned)
            turned = _turned(turned)
    return list(dict.fromkeys(found))


def orientations_of_skeleton(skeleton: Skeleton, kind: str | None) -> Iterator[Skeleton]:
    """A skeleton in the unit square and its other orientations, equal ones included."""
    points = skeleton.points
    for start in (points, np.stack((1 - points[:, 0], points[:, 1]), axis=1)) if kind == "all" else (points,):
        turned = start
        for _ in range(4 if kind else 1):
            yield replace(skeleton, points=turned)
            turned = np.stack((1 - turned[:, 1], turned[:, 0]), axis=1)


def refuse_collisions(path: Path, drawings: Iterable[tuple[str, Rows]], kind: str | None) -> None:
    """Refuses classes that become one another when they are turned or mirrored.

    Raises:
        UsageError: two do; the message names them.
    """
    taken: dict[Rows, str] = {}
    for label, rows in drawings:
        for other in orientations(rows, kind):
            if taken.setdefault(other, label) != label:
                how = "turned" if kind == "turned" else "turned or mirrored"
                raise UsageError(
                    f"{path}: orientations: '{label}' {how} is '{taken[other]}'; leave one of them out, or "
                    "redraw it"
                )


def _turned(rows: Rows) -> Rows:
    """Turned by 90 degrees, clockwise."""
    return tuple("".join(column) for column in zip(*rows[::-1], strict=True))


def _mirrored(rows: Rows) -> Rows:
    return tuple(row[::-1] for row in rows)
