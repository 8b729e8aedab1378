"""Draws what training shows beside the files' drawings: variants, damaged ones, and drawings of no class.

Nothing that is held out for measurements is drawn: neither variants of a held-out form nor any drawing
that `split_of` keeps back. What could be of two classes, or of one and none, is unlabelled: its tiles learn
to agree on one answer, whatever it is.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tilenca.shapes import edits
from tilenca.shapes.batch import UNLABELLED, Drawings
from tilenca.shapes.cells import connected, removable
from tilenca.shapes.derive import known_of
from tilenca.shapes.edits import rows_of
from tilenca.shapes.file import MAX_TILES, UNKNOWN, Shape
from tilenca.shapes.form import make_form
from tilenca.shapes.lattice import random_skeleton
from tilenca.shapes.likeness import index_of
from tilenca.shapes.sizes import Size, Sizes
from tilenca.shapes.stretch import Rows, stretch
from tilenca.shapes.variant import TRAINED, Variants, split_of
from tilenca.shapes.vary import Vary

VARIED, DAMAGED, OF_NO_CLASS, FREE = "varied", "damaged", "of no class", "unlabelled"
ONE_TILE, DEAD = (
    0.5,
    (0.03, 0.16),
)  # share of damaged drawings with one tile missing; share of tiles that others miss
ONE_GAP = 0.9  # the same where tiles learn to say where one is missing
FROM_FILES, FROM_FILES_GAPS = 0.65, 0.3  # share of drawings of the files, and variants, among those to change
TORN = 0.3  # share of damaged drawings that may be torn apart
CLEAR = 30  # tiles of a drawing in which one tile too many leaves no doubt
MOST_EDITS = 3
FEW = 200  # drawings of a task that are compared with each other, tile by tile
TRIES = 50


class Generator:
    """Draws drawings of some kinds.

    Args:
        task: the files' drawings.
        whole: all drawings of a class that stay.
        kinds: the kinds to draw.
        indexed: how many variants the drawings of no class are compared with.
        random: for those.
        gaps: whether tiles learn to say where one is missing: then hardly ever several are, and drawings of
            all sizes are damaged alike.
    """

    def __init__(
        self,
        task: Drawings,
        whole: Sequence[Shape],
        kinds: Sequence[str],
        indexed: int,
        random: np.random.Generator,
        gaps: bool = False,
    ) -> None:
        self.kinds = tuple(kinds)
        self._one_tile = ONE_GAP if gaps else ONE_TILE
        self._from_files = FROM_FILES_GAPS if gaps else FROM_FILES
        self._variants: Variants | None = task.variants
        extents = [(len(shape.rows), len(shape.rows[0])) for shape in whole]
        largest = max(rows for rows, _ in extents), max(cols for _, cols in extents)
        vary = Vary(thickness=(1, 1)) if self._variants is None else self._variants.vary
        self._vary = vary.sized(largest, Sizes())
        self._whole = list(whole)
        self._drawn = list(task.shapes)
        self._strokes = edits.segments([shape.rows for shape in task.group(0)][:FEW])
        # Of thousands of drawings each has many relatives, and one tile more or less proves nothing.
        self._known = known_of(task.shapes) if len(task.shapes) <= FEW else None
        self._labels = [label for label in task.labels if label != UNKNOWN]
        self._taken: dict[Rows, str] = {shape.rows: shape.label for shape in whole}
        self._likeness, drawn = index_of([shape.rows for shape in whole], self._variants, indexed, random)
        for variant in drawn:  # what came up for two classes belongs to neither
            if self._taken.setdefault(variant.rows, variant.label) != variant.label:
                self._taken[variant.rows] = UNLABELLED
        self._sizes: list[Size] = extents if self._variants is None else []
        tallest = max(rows * cols for rows, cols in (*extents, self._vary.most or largest))
        self.most_tiles = min(tallest, MAX_TILES) + 2 * MOST_EDITS

    def draw(self, kind: str, random: np.random.Generator) -> Shape:
        """A drawing of a kind; where none turns up, one of the files', or for no class one in doubt."""
        drawers: dict[str, Callable[[np.random.Generator], Shape | None]] = {
            VARIED: self._varied, DAMAGED: self._damaged, OF_NO_CLASS: self._of_no_class, FREE: self._free
        }  # fmt: skip
        for kind_now in (kind, FREE) if kind == OF_NO_CLASS else (kind,):
            for _ in range(TRIES):
                shape = drawers[kind_now](random)
                if shape is None or len(shape.cells) > self.most_tiles:
                    continue
                if kind != OF_NO_CLASS or shape.label in (UNKNOWN, UNLABELLED):
                    return shape
        return self._drawn[int(random.integers(len(self._drawn)))]

    def _varied(self, random: np.random.Generator) -> Shape | None:
        """A variant of any class."""
        if self._variants is None:
            return None
        label = self._labels[int(random.integers(len(self._labels)))]
        variant = self._variants.draw(label, TRAINED, random)
        if variant is None:
            return None
        doubtful = self._taken.get(variant.rows, label) != label
        return Shape(UNLABELLED if doubtful else label, variant.rows, f"{label} varied")

    def _base(self, random: np.random.Generator) -> Shape | None:
        """Any whole drawing: a variant, one of the files, or a stretched one."""
        chance = random.random()
        if chance < 0.3 and self._variants is not None:
            return self._varied(random)
        among = self._drawn if chance < self._from_files else self._whole
        return among[int(random.integers(len(among)))]

    def _damaged(self, random: np.random.Generator) -> Shape | None:
        """A drawing with one tile missing, or with several."""
        shape = self._base(random)
        if shape is None or len(shape.cells) < 3:
            return None
        cells = list(shape.cells)
        if random.random() < self._one_tile:
            rows = self._without_one(shape, cells, random)
        else:
            gone = max(1, round(random.uniform(*DEAD) * len(cells)))
            left = [cells[n] for n in sorted(random.permutation(len(cells))[gone:].tolist())]
            torn = random.random() < TORN
            rows = rows_of(left) if left and (torn or connected(left)) else None
        if rows is None or split_of(rows) != TRAINED:
            return None
        label = shape.label if self._taken.get(rows, shape.label) == shape.label else UNLABELLED
        return Shape(label, rows, f"{shape.name} damaged")

    def _without_one(
        self, shape: Shape, cells: list[tuple[int, int]], random: np.random.Generator
    ) -> Rows | None:
        if self._known is not None and shape in self._drawn:
            clear = self._known.damaged(shape.label, shape.rows)
            return clear[int(random.integers(len(clear)))] if clear else None
        loose = removable(cells)
        gone = loose[int(random.integers(len(loose)))]
        return rows_of([cell for cell in cells if cell != gone])

    def _of_no_class(self, random: np.random.Generator) -> Shape | None:
        """A drawing that nobody would take for one of the task's."""
        rows, like_strokes = self._stranger(random)
        if rows is None or split_of(rows) != TRAINED or rows in self._taken:
            return None
        if self._variants is None and self._known is not None:
            if self._known.is_known(rows):
                return None
        elif self._likeness.could_be_one(rows, like_strokes):
            return None
        return Shape(UNKNOWN, rows, f"none of {len(rows)}x{len(rows[0])}")

    def _free(self, random: np.random.Generator) -> Shape | None:
        """A drawing whose class is in doubt."""
        chance = random.random()
        if chance < 0.35:
            rows, _ = self._stranger(random)
            if rows is None or split_of(rows) != TRAINED:
                return None
            return Shape(self._taken.get(rows, UNLABELLED), rows, "in doubt")
        shape = self._base(random)
        if shape is None:
            return None
        times = 1 if random.random() < 0.6 else int(random.integers(2, MOST_EDITS + 1))
        rows = _edited(shape, times, random)
        if rows is None or split_of(rows) != TRAINED:
            return None
        clear = times == 1 and len(shape.cells) >= CLEAR
        label = self._taken.get(rows, shape.label if clear else UNLABELLED)
        return Shape(label, rows, f"{shape.name} edited")

    def _stranger(self, random: np.random.Generator) -> tuple[Rows | None, bool]:
        """Any connected drawing, and whether it consists of strokes as those of a class do."""
        height, width = self._size(random)
        chance = random.random()
        if chance < 0.15:
            rows = edits.some_segments(random, self._strokes) if self._strokes else None
            return None if rows is None else stretch(rows, height, width), True
        if chance < 0.45:
            least = min(4, height * width)
            tiles = int(random.integers(least, max(least, round(0.6 * height * width)) + 1))
            return edits.grown(random, tiles, height, width), False
        if chance < 0.75:
            form = make_form(random_skeleton(random), self._vary, random)
            pen = 1 + int(random.random() < 0.3 and self._vary.thickness[1] > 1)
            return form.draw((height, width), (pen, pen)), True
        shape = self._base(random)
        if shape is None:
            return None, True
        if chance < 0.9:
            return edits.half(random, shape.rows), True
        return edits.edited(random, shape.rows, int(random.integers(4, 5 + len(shape.cells) // 4))), True

    def _size(self, random: np.random.Generator) -> Size:
        if self._sizes:
            height, width = self._sizes[int(random.integers(len(self._sizes)))]
            return height + int(random.integers(-1, 2)) or 1, width + int(random.integers(-1, 2)) or 1
        assert self._vary.least is not None
        assert self._vary.most is not None
        (low, slim), (high, wide) = self._vary.least, self._vary.most
        height = int(random.integers(low - 1, high + 1))
        return max(1, height), int(random.integers(slim, max(slim, min(wide, height)) + 1))


def _edited(shape: Shape, times: int, random: np.random.Generator) -> Rows | None:
    """The drawing with some tiles too many or too few at its border; None where that tears it apart."""
    tiles = set(shape.cells)
    for _ in range(times):
        cells = sorted(tiles)
        row, col = cells[int(random.integers(len(cells)))]
        if random.random() < 0.5 and len(tiles) > 2:
            tiles.remove((row, col))
        else:
            down, right = ((0, 1), (1, 0), (0, -1), (-1, 0))[int(random.integers(4))]
            tiles.add((row + down, col + right))
    return rows_of(tiles) if connected(tiles) and tiles != set(shape.cells) else None
