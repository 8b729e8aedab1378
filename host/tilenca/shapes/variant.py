"""Drawings of a class at any size and thickness, by chance: what a class may become.

`Variants` draws them for one task, and keeps forms and drawings apart for measurements. numpy only.
"""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tilenca.base.errors import UsageError
from tilenca.shapes.form import Form, make_form
from tilenca.shapes.sizes import Size
from tilenca.shapes.skeleton import Skeleton
from tilenca.shapes.stretch import Rows, smallest
from tilenca.shapes.vary import Vary

THINNER = 0.45  # how much rarer each further tile of thickness is
UNEVEN = 0.3  # the share of pens that are thicker one way than the other
SLIMMEST, WIDEST = 0.35, 1.1  # width by height
TRIES = 12  # sizes and pens of one form
MOST_DRAWS = 300  # for each variant that is wanted
HELD_OUT = 4  # one form of so many is held out of training, and one drawing of so many
TRAINED, CHOOSING, LAST = "trained", "choosing", "last"


@dataclass(frozen=True)
class Variant:
    """A drawing.

    Attributes:
        label: its class.
        rows: the drawing.
        split: `TRAINED`, or which measurement it is held out for: `CHOOSING` models, or the `LAST` one.
        thickness: of its strokes, the larger of both ways.
    """

    label: str
    rows: Rows
    split: str
    thickness: int


class Variants:
    """Draws variants of a task's classes.

    Args:
        skeletons: (label, skeleton) in a unit square; a class may have several.
        vary: how far they may differ; with sizes.
        avoid: sizes of bounding boxes that are never drawn.
    """

    def __init__(
        self, skeletons: Sequence[tuple[str, Skeleton]], vary: Vary, avoid: Sequence[Size] = ()
    ) -> None:
        if vary.least is None or vary.most is None:
            raise ValueError("variants need a smallest and a largest size, see Vary.sized")
        self.vary, self.least, self.most = vary, vary.least, vary.most
        self.labels = tuple(dict.fromkeys(label for label, _ in skeletons))
        self.skeletons = tuple(skeletons)
        self._of = {label: [s for of, s in skeletons if of == label and s.edges] for label in self.labels}
        self._avoid = frozenset(avoid)
        shares = THINNER ** np.arange(vary.thickness[1] - vary.thickness[0] + 1)
        self._thickness = np.cumsum(shares / shares.sum())

    def draw(self, label: str, split: str, random: np.random.Generator) -> Variant | None:
        """One variant of a class.

        Args:
            label: the class.
            split: the side of the split. `TRAINED` ones share no form and no drawing with the others at any
                size; `CHOOSING` and `LAST` share no drawing.
            random: the only source of chance.

        Returns:
            None where the form that came up is on another side, or fits no size; a single tile has no forms.
        """
        skeletons = self._of[label]
        if not skeletons:
            return None
        form = make_form(skeletons[int(random.integers(len(skeletons)))], self.vary, random)
        if (form.key() % HELD_OUT == 0) == (split == TRAINED):
            return None
        for _ in range(TRIES):
            pen = self._pen(random)
            rows = form.draw(self._size(form, pen, random), pen)
            if rows is not None and (len(rows), len(rows[0])) not in self._avoid:
                return Variant(label, rows, split, max(pen)) if split_of(rows) == split else None
        return None

    def some(
        self, label: str, count: int, random: np.random.Generator, path: Path, split: str = TRAINED
    ) -> list[Rows]:
        """Different variants of a class; fewer where hardly a new one turns up.

        Args:
            label: the class.
            count: how many.
            random: the only source of chance.
            path: the file of the class.
            split: the side of the split, see `draw`.

        Raises:
            UsageError: none can be drawn; the message names the file, the class and the remedy.
        """
        found: dict[Rows, None] = {}
        for _ in range(MOST_DRAWS * count):
            variant = self.draw(label, split, random)
            if variant is not None:
                found.setdefault(variant.rows)
            if len(found) == count:
                break
        if not found:
            raise UsageError(f"{path}: no variant of '{label}' can be drawn; allow larger sizes in [vary]")
        return list(found)

    def _pen(self, random: np.random.Generator) -> tuple[int, int]:
        least, most = self.vary.thickness
        thick = least + int(np.searchsorted(self._thickness, random.random()))
        pen = [thick, thick]
        if random.random() < UNEVEN:
            pen[int(random.integers(2))] = min(most, thick + 1)
        return pen[0], pen[1]

    def _size(self, form: Form, pen: tuple[int, int], random: np.random.Generator) -> Size:
        (low, slim), (high, wide) = self.least, self.most
        rows = int(random.integers(low, high + 1))
        least = min(max(slim, round(SLIMMEST * rows)), wide)
        cols = int(random.integers(least, max(least, min(wide, round(WIDEST * rows))) + 1))
        return rows, min(max(round(cols * min(form.aspect, 1.2)), pen[1]), wide)


def split_of(rows: Rows) -> str:
    """The side of the split that a drawing is on, at all sizes to which it can be stretched."""
    part = zlib.crc32("/".join(smallest(rows)).encode())
    if part % HELD_OUT:
        return TRAINED
    return CHOOSING if part // HELD_OUT % 2 else LAST
