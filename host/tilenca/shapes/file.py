"""Shape files: the drawings that a model tells apart.

A file is TOML: `[[shape]]` tables with `label = "4"` and a `grid` of text rows, `#` a tile and `.` or a blank
none. All shapes of one file form one task; a label may recur (variants of one class). The classes are the
labels in order of first appearance. A table `[sizes]` lists other sizes at which the task's drawings keep
their class (`tilenca.shapes.sizes`); `[vary]` and `[forms]` say how far drawings of a class may differ
(`tilenca.shapes.vary`), and `orientations` whether they may be turned or mirrored (`tilenca.shapes.orient`).
"""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tilenca.base.errors import Mistakes, UsageError
from tilenca.base.parsing import read_toml
from tilenca.base.shipped import shapes_names
from tilenca.base.sides import OFFSETS
from tilenca.base.suggest import did_you_mean
from tilenca.shapes.cells import cells_of
from tilenca.shapes.glyphs import GLYPHS
from tilenca.shapes.orient import (
    orientations,
    orientations_of_skeleton,
    read_orientations,
    refuse_collisions,
)
from tilenca.shapes.sizes import Size, Sizes, read_sizes, size_name
from tilenca.shapes.skeleton import Skeleton
from tilenca.shapes.stretch import stretch
from tilenca.shapes.tables import Table, tables_of
from tilenca.shapes.vary import Vary, read_forms, read_vary

KEYS = ("shape", "sizes", "vary", "forms", "orientations")
UNKNOWN = "-"  # the label of drawings of no class
MAX_TILES = 255  # of a drawing: as many as tiles can have different ids, which are one byte

_PLACE = re.compile(r" \(at line (\d+), column \d+\)$")


@dataclass(frozen=True)
class Shape:
    """One drawing.

    Attributes:
        label: the character its tiles show.
        rows: the drawing, rectangular, `#` and `.` only, without empty border rows or columns.
        name: the label, or `label@k` for the k-th drawing (from 2) of the same label.
    """

    label: str
    rows: tuple[str, ...]
    name: str

    @property
    def grid(self) -> str:
        """The drawing as text, rows joined by newlines."""
        return "\n".join(self.rows)

    @property
    def cells(self) -> tuple[tuple[int, int], ...]:
        """(row, column) of every tile in reading order."""
        return cells_of(self.rows)

    def stretched(self, size: Size, up: bool = True) -> "Shape | None":
        """The drawing at another size (`tilenca.shapes.stretch`), None if it cannot be drawn that small."""
        rows = stretch(self.rows, *size, up)
        return None if rows is None else Shape(self.label, rows, f"{self.name} {size_name(size)}")

    def neighbours(self) -> list[list[int]]:
        """For every tile the indices into `cells` of its N, E, S, W neighbour, -1 for none."""
        index = {cell: number for number, cell in enumerate(self.cells)}
        return [[index.get((row + dr, col + dc), -1) for dr, dc in OFFSETS] for row, col in self.cells]


@dataclass(frozen=True)
class Task:
    """All shapes of one file and the classes they form."""

    path: Path
    shapes: tuple[Shape, ...]
    labels: tuple[str, ...]
    sizes: Sizes = field(default_factory=Sizes)
    vary: Vary | None = field(default_factory=Vary)
    forms: tuple[tuple[str, Skeleton], ...] = ()

    def find(self, name: str) -> Shape:
        """The shape called `name` (`4`, or `4@2` for the second drawing of "4").

        Raises:
            UsageError: the file has none; the message lists its shapes.
        """
        return self.shapes[find_shape(self.shapes, name, self.path)]


def find_shape(shapes: Sequence[Shape], name: str, path: Path) -> int:
    """The index of the shape called `name`.

    Raises:
        UsageError: there is none; the message names the file and lists its shapes.
    """
    for number, shape in enumerate(shapes):
        if shape.name == name:
            return number
    names = [shape.name for shape in shapes]
    raise UsageError(f"{path}: no shape '{name}'{did_you_mean(name, names)}; it has: {' '.join(names)}")


def too_large(shapes: Sequence[Shape]) -> str | None:
    """What to say of the first drawing with more tiles than there are ids; None: there is no such drawing."""
    for shape in shapes:
        if (tiles := len(shape.cells)) > MAX_TILES:
            return f"shape '{shape.name}' has {tiles} tiles; the most that ids allow are {MAX_TILES}"
    return None


def load_task(path: Path, max_classes: int | None = None) -> Task:
    """Reads and checks a shape file.

    Args:
        path: the TOML file.
        max_classes: how many classes the model's state has room for; None: not checked.

    Raises:
        UsageError: the file cannot be read or is not a valid task; the message has a line for each mistake,
            with file, line and remedy.
    """
    text, document = _read(path)
    mistakes = Mistakes()
    entries = document.pop("shape", None)
    sizes, vary, kind = Sizes(), None, None
    with mistakes.gathered():
        sizes = read_sizes(path, document.pop("sizes", {}))
    with mistakes.gathered():
        vary = read_vary(path, document.pop("vary", {}))
    forms = document.pop("forms", {})
    with mistakes.gathered():
        kind = read_orientations(path, document.pop("orientations", None))
    for key in document:
        where, meant = f"{path}{_line_of(text, key)}", did_you_mean(key, KEYS)
        mistakes.add(
            f"{where}: unknown key {key!r}{meant}; a shape file has [[shape]] tables, [sizes], [vary], "
            "[forms] and orientations"
        )
    if not isinstance(entries, list) or not entries or not all(isinstance(entry, dict) for entry in entries):
        mistakes.add(f"{path}: no shapes; add [[shape]] tables with a label and a grid")
        entries = []
    drawn = _task(path, tables_of(path, text, entries), max_classes, mistakes)
    found: tuple[tuple[str, Skeleton], ...] = ()
    with mistakes.gathered():
        found = read_forms(path, forms, [str(entry.get("label")) for entry in entries])
    mistakes.refuse()
    skeletons = tuple(
        (label, other) for label, skeleton in found for other in orientations_of_skeleton(skeleton, kind)
    )
    return replace(_in_all(drawn, kind), sizes=sizes, vary=vary, forms=skeletons)


def _line_of(text: str, key: str) -> str:
    """The line of a key or table of that name, as a message has it; nothing where it is written unusually."""
    begins = re.compile(rf"\s*\[*\s*[\"']?{re.escape(key)}[\"']?\s*[\]=.]")
    lines = (number for number, line in enumerate(text.split("\n"), start=1) if begins.match(line))
    return f":{line}" if (line := next(lines, 0)) else ""


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    """The text of a file, and what TOML makes of it.

    Raises:
        UsageError: it cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return text, read_toml(text)
    except OSError as error:
        raise UsageError(
            f"{path}: {error.strerror}{_near(path)}; give a shape file, or one of: {' '.join(shapes_names())}"
        ) from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not UTF-8 text at byte {error.start}; save the file as UTF-8") from error
    except ValueError as error:
        about = str(error)
        line = f":{place[1]}" if (place := _PLACE.search(about)) else ""
        raise UsageError(f"{path}{line}: not valid TOML: {_PLACE.sub('', about)}") from error


def _near(path: Path) -> str:
    """A shape file of about that name in its folder, if there is one."""
    with suppress(OSError):
        return did_you_mean(path.name, [other.name for other in path.parent.glob("*.toml")])
    return ""


def _in_all(task: Task, kind: str | None) -> Task:
    """The task with its drawings in all orientations."""
    if kind is None:
        return task
    refuse_collisions(task.path, ((shape.label, shape.rows) for shape in task.shapes), kind)
    shapes = {shape.rows: shape for shape in task.shapes}
    count = Counter(shape.label for shape in task.shapes)
    for shape in task.shapes:
        for rows in orientations(shape.rows, kind):
            if rows not in shapes:
                count[shape.label] += 1
                shapes[rows] = Shape(shape.label, rows, f"{shape.label}@{count[shape.label]}")
    return replace(task, shapes=tuple(shapes.values()))


def _task(path: Path, tables: Sequence[Table], max_classes: int | None, mistakes: Mistakes) -> Task:
    """The shapes of a file's tables; of those with mistakes nothing but their labels."""
    shapes: dict[tuple[str, ...], Shape] = {}
    labels: dict[str, None] = {}
    drawn: Counter[str] = Counter()
    for table in tables:
        label, rows = None, None
        with mistakes.gathered():
            table.check_keys()
        with mistakes.gathered():
            label = table.label()
            if label not in labels and len(labels) == max_classes:
                mistakes.add(
                    f"{table.at(table.lines.label)}: '{label}' is class {len(labels) + 1}, the model's state "
                    f"has room for {max_classes}; draw fewer classes or train with a wider --state"
                )
            _check_looks(table, label, labels)
            labels[label] = None
        with mistakes.gathered():
            rows = table.rows()
            if rows in shapes:
                where, twin = table.at(table.lines.grid), shapes[rows].name
                raise UsageError(
                    f"{where}: {table.name} is drawn exactly like '{twin}'; remove or redraw one"
                )
        if label is not None and rows is not None and rows not in shapes:
            drawn[label] += 1
            shapes[rows] = Shape(label, rows, label if drawn[label] == 1 else f"{label}@{drawn[label]}")
    return Task(path, tuple(shapes.values()), tuple(labels))


def _check_looks(table: Table, label: str, labels: Iterable[str]) -> None:
    """Refuses a label that looks like one of the others."""
    for other in labels:
        if other != label and GLYPHS[other] == GLYPHS[label]:
            raise UsageError(
                f"{table.at(table.lines.label)}: labels '{label}' and '{other}' look the same on a 7-segment "
                "digit; rename one"
            )


def shape_table(label: str, rows: Sequence[str]) -> str:
    """A drawing as a table of a shape file."""
    grid = "\n".join(rows)
    return f'[[shape]]\nlabel = "{label}"\ngrid = """\n{grid}\n"""\n'
