"""The fleet drawn in a terminal: each tile a box in its place, with its digit, step, links and age. Pure."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from rich.text import Text

from tilenca.base.sides import SIDES
from tilenca.fleet.grid import Cell, Mark, Position
from tilenca.fleet.link_health import WELL
from tilenca.shapes.glyphs import BLANK, GLYPHS, draw
from tilenca.views.tiles import digit, led_style

INSIDE = 11
BOX_WIDTH, BOX_HEIGHT, LINE_WIDTH = INSIDE + 2, 5, 10
STYLES = {
    Mark.NONE: "dim",
    Mark.WELL: "green",
    Mark.FAILING: "bold yellow",
    Mark.DEAD: "bold red",
    Mark.FOREIGN: "bold magenta",
}
BOX = "dim"
TROUBLE = "yellow"
STALE_S = 1.0


@dataclass(frozen=True)
class Charset:
    """The characters of boxes and links: corners, then a horizontal and a vertical line for each mark."""

    corners: str
    across: Mapping[Mark, str]
    down: Mapping[Mark, str]


def _charset(corners: str, across: str, down: str) -> Charset:
    return Charset(corners, dict(zip(Mark, across, strict=True)), dict(zip(Mark, down, strict=True)))


LINES = _charset("┌┐└┘", "─━╍╳?", "│┃╏╳?")  # noqa: RUF001
ASCII = _charset("++++", "-=~x?", "|#:x?")


def short(number: int | None) -> str:
    """A number in at most four characters."""
    if number is None:
        return ""
    for size, unit in ((1, ""), (1000, "k"), (1_000_000, "M"), (1_000_000_000, "G")):
        if number < 1000 * size or (size == 1 and number < 10_000):
            return f"{number // size}{unit}"
    return "9999"


def age_text(age_s: float | None) -> str:
    """An age in at most four characters; "" for a fresh one."""
    if age_s is None or age_s < STALE_S:
        return ""
    if age_s < 100:
        return f"{age_s:.0f}s"
    return f"{age_s / 60:.0f}m" if age_s < 6000 else f"{min(age_s / 3600, 999):.0f}h"


def draw_fitting(
    grid: Mapping[Position, Cell], width: int, height: int, ascii_only: bool
) -> list[Text] | None:
    """The larger of `full` and `small` that fits; None if neither does. Draws only as much as needed."""
    if not grid:
        return []
    rows, cols = _extent(row for row, _ in grid), _extent(col for _, col in grid)
    if len(rows) * BOX_HEIGHT <= height and len(cols) * BOX_WIDTH <= width:
        return full(grid, ascii_only)
    return small(grid) if len(rows) <= height and len(cols) * LINE_WIDTH <= width else None


def _extent(numbers: Iterable[int]) -> range:
    known = list(numbers)
    return range(min(known), max(known) + 1)


def full(grid: Mapping[Position, Cell], ascii_only: bool) -> list[Text]:
    """Every tile as a box of 13 by 5 characters."""
    charset = ASCII if ascii_only else LINES
    return _lines(grid, lambda cell: _box(cell, charset), BOX_WIDTH, BOX_HEIGHT)


def small(grid: Mapping[Position, Cell]) -> list[Text]:
    """Every tile on one line: id, digit, links."""
    return _lines(grid, lambda cell: [_line(cell)], LINE_WIDTH, 1)


def _lines(
    grid: Mapping[Position, Cell], drawn: Callable[[Cell], Sequence[Text]], width: int, height: int
) -> list[Text]:
    if not grid:
        return []
    cols = _extent(col for _, col in grid)
    lines: list[Text] = []
    for row in _extent(row for row, _ in grid):
        blocks = [
            drawn(grid[row, col]) if (row, col) in grid else [Text(" " * width)] * height for col in cols
        ]
        for number in range(height):
            line = Text.assemble(*(block[number] for block in blocks))
            line.rstrip()
            lines.append(line)
    return lines


def _box(cell: Cell, charset: Charset) -> list[Text]:
    frame = TROUBLE if cell.trouble else BOX
    marks = {side: cell.marks.get(side, Mark.NONE) for side in SIDES}
    top, bottom = charset.corners[:2], charset.corners[2:]
    plain = charset.across[Mark.NONE]

    def edge(left: str, side: str, right: str, corners: str) -> Text:
        mark = marks[side]
        link = (charset.across[mark] * 3, STYLES[mark])
        before, after = left.ljust(4, plain), right.rjust(4, plain)
        return Text.assemble((corners[0] + before, frame), link, (after + corners[1], frame))

    def side(name: str) -> tuple[str, str]:
        return charset.down[marks[name]], STYLES[marks[name]]

    name = "?" if cell.tile is None else str(cell.tile)
    percent = "" if cell.good is None or cell.good >= WELL else f"{cell.good:.0%}"
    middle = [
        Text.assemble(side("W"), (part, style), side("E")) for part, style in _face(cell, charset is ASCII)
    ]
    return [
        edge(f"{plain}{name}", "N", percent, top),
        *middle,
        edge(short(cell.updates).rjust(4, plain), "S", age_text(cell.age_s), bottom),
    ]


def _face(cell: Cell, ascii_only: bool) -> list[tuple[str, str]]:
    """The three lines inside a box."""
    if cell.trouble and cell.label is None:
        return [(text.center(INSIDE), TROUBLE) for text in ("", cell.trouble, "")]
    segments = GLYPHS.get(cell.label or "", BLANK)
    rows = draw(segments) if ascii_only else digit(segments)
    style = TROUBLE if cell.trouble else led_style(cell.colour)
    lines = [(row.center(INSIDE), style) for row in rows]
    if cell.trouble:
        lines[0] = (cell.trouble.center(INSIDE), TROUBLE)
    return lines


def _line(cell: Cell) -> Text:
    name = "?" if cell.tile is None else str(cell.tile)
    shown = cell.label or ("." if cell.label is not None else " ")
    links = "".join(
        " " if (mark := cell.marks.get(side, Mark.NONE)) is Mark.NONE else side if mark is Mark.WELL else "!"
        for side in SIDES
    )
    style = TROUBLE if cell.trouble else led_style(cell.colour)
    return Text.assemble(
        (f"{name:>3} ", TROUBLE if cell.trouble else ""), (shown, style), (f"{links}  "[:5].rjust(5), BOX)
    )
