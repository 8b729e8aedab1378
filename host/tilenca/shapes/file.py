"""Shape files: the drawings that a model tells apart.

A file is TOML: `[[shape]]` tables with `label = "4"` and a `grid` of text rows, `#` a tile and `.` or a blank
none. All shapes of one file form one task; a label may recur (variants of one class). The classes are the
labels in order of first appearance. A table `[sizes]` lists other sizes at which the task's drawings keep
their class (`tilenca.shapes.sizes`); `[vary]` and `[forms]` say how far drawings of a class may differ
(`tilenca.shapes.vary`), and `orientations` whether they may be turned or mirrored (`tilenca.shapes.orient`).
"""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_toml
from tilenca.base.shipped import shapes_names
from tilenca.base.sides import OFFSETS
from tilenca.base.suggest import did_you_mean
from tilenca.shapes.cells import TILE, apart, cells_of, connected
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
from tilenca.shapes.vary import Vary, read_forms, read_vary

EMPTY = ".", " "
KEYS = ("shape", "sizes", "vary", "forms", "orientations")
UNKNOWN = "-"  # the label of drawings of no class
MAX_TILES = 255  # of a drawing: as many as tiles can have different ids, which are one byte

_HEADER = re.compile(r"\s*\[\[\s*shape\s*\]\]\s*(#.*)?$")
_GRID = re.compile(r"""\s*grid\s*=\s*(?P<quotes>\"{3}|'{3})?(?P<row>.*?)\s*$""")


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
        UsageError: the file cannot be read or is not a valid task; the message names file, line and remedy.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(
            f"{path}: {error.strerror}{_near(path)}; give a shape file, or one of: {' '.join(shapes_names())}"
        ) from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not UTF-8 text at byte {error.start}; save the file as UTF-8") from error
    try:
        document = read_toml(text)
    except ValueError as error:
        raise UsageError(f"{path}: not valid TOML: {error}") from error
    tables = document.pop("shape", None)
    sizes = read_sizes(path, document.pop("sizes", {}))
    vary = read_vary(path, document.pop("vary", {}))
    forms = document.pop("forms", {})
    kind = read_orientations(path, document.pop("orientations", None))
    if document:
        key = next(iter(document))
        raise UsageError(
            f"{path}: unknown key '{key}'{did_you_mean(key, KEYS)}; a shape file has [[shape]] tables, "
            "[sizes], [vary], [forms] and orientations"
        )
    if not isinstance(tables, list) or not tables or not all(isinstance(table, dict) for table in tables):
        raise UsageError(f"{path}: no shapes; add [[shape]] tables with a label and a grid")
    task = _in_all(_task(path, tables, list(_table_lines(text)), max_classes), kind)
    skeletons = tuple(
        (label, other)
        for label, skeleton in read_forms(path, forms, task.labels)
        for other in orientations_of_skeleton(skeleton, kind)
    )
    return replace(task, sizes=sizes, vary=vary, forms=skeletons)


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


def _task(
    path: Path, tables: list[dict[str, object]], lines: list[tuple[int, int]], max_classes: int | None
) -> Task:
    shapes: dict[tuple[str, ...], Shape] = {}
    labels: list[str] = []
    drawn: Counter[str] = Counter()
    for number, table in enumerate(tables):
        # Tables written in an unusual form (inline, quoted keys) have no known line: name their number.
        header, grid_line = lines[number] if len(lines) == len(tables) else (0, 0)
        where = f"{path}:{header}" if header else f"{path}: shape {number + 1}"
        label = _label(where, table, labels)
        rows = _rows(
            where, f"{path}:{grid_line}" if grid_line else where, grid_line, label, table.get("grid")
        )
        if label not in labels:
            labels.append(label)
        if max_classes is not None and len(labels) > max_classes:
            raise UsageError(
                f"{where}: '{label}' is class {len(labels)}, the model's state has room for {max_classes}; "
                "draw fewer classes or train with a wider --state"
            )
        if rows in shapes:
            raise UsageError(
                f"{where}: '{label}' is drawn exactly like '{shapes[rows].name}'; remove or redraw one"
            )
        drawn[label] += 1
        shapes[rows] = Shape(label, rows, label if drawn[label] == 1 else f"{label}@{drawn[label]}")
    return Task(path, tuple(shapes.values()), tuple(labels))


def _label(where: str, table: dict[str, object], labels: list[str]) -> str:
    unknown = [key for key in table if key not in ("label", "grid")]
    if unknown:
        raise UsageError(f"{where}: unknown key '{unknown[0]}'; a shape has a label and a grid")
    label = table.get("label")
    if not isinstance(label, str) or label not in GLYPHS:
        shown = "missing" if label is None else repr(label)
        quoted = isinstance(label, int) and str(label) in GLYPHS
        remedy = f'write "{label}", in quotes' if quoted else _other_label(label)
        raise UsageError(f"{where}: label {shown}; {remedy}")
    for other in labels:
        if other != label and GLYPHS[other] == GLYPHS[label]:
            raise UsageError(
                f"{where}: labels '{label}' and '{other}' look the same on a 7-segment digit; rename one"
            )
    return label


def _other_label(label: object) -> str:
    """What a label may be, with one that is near the given one where there is any."""
    shown = f"a 7-segment digit shows {''.join(GLYPHS)}"
    first = label[:1] if isinstance(label, str) else ""
    near = next((other for other in (first, first.swapcase()) if other in GLYPHS), None)
    if isinstance(label, str) and len(label) > 1:
        such = f", such as '{near}'" if near else ""
        return f"it is the one character that the tiles are to show{such}; {shown}"
    return f"did you mean '{near}'? {shown}" if near else shown


def _rows(where: str, grid_where: str, grid_line: int, label: str, grid: object) -> tuple[str, ...]:
    if not isinstance(grid, str):
        raise UsageError(f'{where}: shape \'{label}\' has no grid; add grid = """..."""')
    rows = [row.rstrip("\r") for row in grid.split("\n")]
    drawn = [index for index, row in enumerate(rows) if row.strip()]
    # Blank rows above and below are how the text is laid out; between others they are part of the drawing.
    numbered = [(index, rows[index]) for index in range(drawn[0], drawn[-1] + 1)] if drawn else []
    for index, row in numbered:
        line = f"{grid_where.rsplit(':', 1)[0]}:{grid_line + index}" if grid_line else where
        for column, mark in enumerate(row):
            if mark != TILE and mark not in EMPTY:
                raise UsageError(
                    f"{line}: shape '{label}', column {column + 1}: unknown character {mark!r}; "
                    "use '#' for a tile and '.' for none"
                )
        if len(row) != len(numbered[0][1]):
            raise UsageError(
                f"{line}: shape '{label}' has ragged rows ({len(row)} characters, the first row has "
                f"{len(numbered[0][1])}); make all rows equally long"
            )
    marks = ["".join(TILE if mark == TILE else "." for mark in row) for _, row in numbered]
    cells = cells_of(marks)
    if not cells:
        raise UsageError(f"{grid_where}: shape '{label}' has no tile; draw at least one '#'")
    if not connected(cells):
        lost_row, lost_column = apart(cells)
        raise UsageError(
            f"{grid_where}: shape '{label}' is not connected: the tile in row {lost_row + 1}, "
            f"column {lost_column + 1} is apart; tiles must touch by their sides"
        )
    top, bottom = cells[0][0], cells[-1][0]
    left, right = min(c for _, c in cells), max(c for _, c in cells)
    return tuple(row[left : right + 1] for row in marks[top : bottom + 1])


def _table_lines(text: str) -> Iterator[tuple[int, int]]:
    """For every `[[shape]]` header its line and the line of its grid's first text row (0: not found)."""
    header = grid = 0
    for number, line in enumerate(text.split("\n"), start=1):
        if _HEADER.match(line):
            if header:
                yield header, grid
            header, grid = number, 0
        elif header and not grid and (opening := _GRID.match(line)):
            # TOML drops a newline that directly follows the opening quotes: row 0 is then on the next line.
            grid = number + 1 if opening["quotes"] and not opening["row"] else number
    if header:
        yield header, grid


def shape_table(label: str, rows: Sequence[str]) -> str:
    """A drawing as a table of a shape file."""
    grid = "\n".join(rows)
    return f'[[shape]]\nlabel = "{label}"\ngrid = """\n{grid}\n"""\n'
