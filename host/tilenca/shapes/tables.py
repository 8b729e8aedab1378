"""One `[[shape]]` table of a shape file: its label and its grid, and the lines on which they stand."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import Mistakes, UsageError
from tilenca.base.suggest import did_you_mean
from tilenca.shapes.cells import TILE, apart, cells_of, connected
from tilenca.shapes.glyphs import GLYPHS

EMPTY = ".", " "
KEYS = "label", "grid"

_HEADER = re.compile(r"\s*\[\[\s*shape\s*\]\]\s*(#.*)?$")
_LABEL = re.compile(r"\s*label\s*=")
_GRID = re.compile(r"""\s*grid\s*=\s*(?P<quotes>\"{3}|'{3})?(?P<row>.*?)\s*$""")


@dataclass
class Lines:
    """Where a table stands in its file, by lines from 1; 0: not found.

    Attributes:
        header: the line of `[[shape]]`.
        label: of the label.
        grid: of the first text row of the grid.
        apart: whether each row is on a line of its own.
    """

    header: int = 0
    label: int = 0
    grid: int = 0
    apart: bool = True


@dataclass(frozen=True)
class Table:
    """A table as TOML has read it.

    Attributes:
        path: the file.
        number: which table it is, from 1.
        lines: where it stands.
        entries: its keys and values.
    """

    path: Path
    number: int
    lines: Lines
    entries: dict[str, object]

    @property
    def name(self) -> str:
        """What to call it in a message: by its label, or its number where the label is none."""
        label = self.entries.get("label")
        return f"shape {label!r}" if isinstance(label, str) else f"shape {self.number}"

    def at(self, line: int) -> str:
        """The file and a line; the table's own where that is not known, or else its number."""
        known = line or self.lines.header
        return f"{self.path}:{known}" if known else f"{self.path}: shape {self.number}"

    def label(self) -> str:
        """The character that the tiles are to show.

        Raises:
            UsageError: there is none that they can show.
        """
        label = self.entries.get("label")
        if not isinstance(label, str) or label not in GLYPHS:
            shown = "missing" if label is None else repr(label)
            quoted = isinstance(label, int) and str(label) in GLYPHS
            remedy = f'write "{label}", in quotes' if quoted else _other_label(label)
            raise UsageError(f"{self.at(self.lines.label)}: label {shown}; {remedy}")
        return label

    def rows(self) -> tuple[str, ...]:
        """The drawing, rectangular, without empty rows and columns around it.

        Raises:
            UsageError: it is not one whole drawing; a line of the message for each mistake.
        """
        grid = self.entries.get("grid")
        if not isinstance(grid, str):
            raise UsageError(f'{self.at(0)}: {self.name} has no grid; add grid = """..."""')
        rows = [row.rstrip("\r") for row in grid.split("\n")]
        drawn = [index for index, row in enumerate(rows) if row.strip()]
        # Blank rows above and below are how the text is laid out; between others they belong to the drawing.
        numbered = [(index, rows[index]) for index in range(drawn[0], drawn[-1] + 1)] if drawn else []
        self._check_rows(numbered)
        return self._whole(["".join(TILE if mark == TILE else "." for mark in row) for _, row in numbered])

    def _check_rows(self, numbered: Sequence[tuple[int, str]]) -> None:
        mistakes = Mistakes()
        usual = Counter(len(row) for _, row in numbered).most_common(1)[0][0] if numbered else 0
        for index, row in numbered:
            where = self.at(self.lines.grid and self.lines.grid + index * self.lines.apart)
            foreign = [column for column, mark in enumerate(row) if mark != TILE and mark not in EMPTY]
            if foreign:
                mistakes.add(
                    f"{where}: {self.name}, column {foreign[0] + 1}: unknown character {row[foreign[0]]!r}; "
                    "use '#' for a tile and '.' for none"
                )
            if len(row) != usual:
                here = f"{len(row)} character{'s' * (len(row) != 1)}"
                mistakes.add(
                    f"{where}: {self.name} has ragged rows (here {here}, elsewhere {usual}); "
                    "fill the short ones up with '.'"
                )
        mistakes.refuse()

    def _whole(self, marks: Sequence[str]) -> tuple[str, ...]:
        cells, where = cells_of(marks), self.at(self.lines.grid)
        if not cells:
            raise UsageError(f"{where}: {self.name} has no tile; draw at least one '#'")
        if not connected(cells):
            row, column = apart(cells)
            raise UsageError(
                f"{where}: {self.name} is not connected: the tile in row {row + 1}, column {column + 1} is "
                "apart; tiles must touch by their sides"
            )
        top, bottom = cells[0][0], cells[-1][0]
        left, right = min(c for _, c in cells), max(c for _, c in cells)
        return tuple(row[left : right + 1] for row in marks[top : bottom + 1])

    def check_keys(self) -> None:
        """Refuses keys that a shape does not have.

        Raises:
            UsageError: there is such a key.
        """
        for key in self.entries:
            if key not in KEYS:
                meant = did_you_mean(key, KEYS)
                raise UsageError(f"{self.at(0)}: unknown key {key!r}{meant}; a shape has a label and a grid")


def tables_of(path: Path, text: str, entries: Sequence[dict[str, object]]) -> list[Table]:
    """The tables of a file, with their lines.

    Those written in an unusual form (inline, quoted keys) have no known line: messages have their number.
    """
    lines = list(_lines(text))
    if len(lines) != len(entries):
        lines = [Lines() for _ in entries]
    return [
        Table(path, number, *about) for number, about in enumerate(zip(lines, entries, strict=True), start=1)
    ]


def _lines(text: str) -> Iterator[Lines]:
    found: Lines | None = None
    for number, line in enumerate(text.split("\n"), start=1):
        if _HEADER.match(line):
            if found:
                yield found
            found = Lines(number)
        elif found and not found.label and _LABEL.match(line):
            found.label = number
        elif found and not found.grid and (opening := _GRID.match(line)):
            # TOML drops a newline that directly follows the opening quotes: row 0 is then on the next line.
            found.grid = number + 1 if opening["quotes"] and not opening["row"] else number
            found.apart = opening["quotes"] is not None
    if found:
        yield found


def _other_label(label: object) -> str:
    """What a label may be, with one that is near the given one where there is any."""
    shown = f"a 7-segment digit shows {''.join(GLYPHS)}"
    first = label[:1] if isinstance(label, str) else ""
    near = next((other for other in (first, first.swapcase()) if other in GLYPHS), None)
    if isinstance(label, str) and len(label) > 1:
        such = f", such as '{near}'" if near else ""
        return f"it is the one character that the tiles are to show{such}; {shown}"
    return f"did you mean '{near}'? {shown}" if near else shown
