"""Drawings side by side in the terminal, two rows of tiles in one line of text."""

from collections.abc import Iterator, Sequence

from tilenca.shapes.stretch import Rows

GAP = "   "
HALVES = {(False, False): " ", (True, False): "▀", (False, True): "▄", (True, True): "█"}


def half_blocks(rows: Rows) -> list[str]:
    """The drawing as text; every character is two tiles, one above the other."""
    height, width = len(rows), len(rows[0])
    padded = [*rows, "." * width]
    return [
        "".join(HALVES[padded[row][col] == "#", padded[row + 1][col] == "#"] for col in range(width))
        for row in range(0, height, 2)
    ]


def side_by_side(drawings: Sequence[tuple[str, Rows]], width: int) -> Iterator[str]:
    """Lines of text with the drawings in as many rows as they need.

    Args:
        drawings: titles and drawings; a title may be empty.
        width: of the terminal, in characters; a drawing that is wider has a row of its own.
    """
    line: list[tuple[str, list[str]]] = []
    used = 0
    for title, rows in drawings:
        block = half_blocks(rows)
        wide = max(len(title), len(rows[0]))
        if line and used + len(GAP) + wide > width:
            yield from _together(line)
            line, used = [], 0
        line.append((title, block))
        used += wide + len(GAP) * (len(line) > 1)
    if line:
        yield from _together(line)


def _together(line: Sequence[tuple[str, list[str]]]) -> Iterator[str]:
    widths = [max(len(title), *map(len, block)) for title, block in line]
    if any(title for title, _ in line):
        yield GAP.join(title.ljust(wide) for (title, _), wide in zip(line, widths, strict=True)).rstrip()
    for row in range(max(len(block) for _, block in line)):
        parts = [
            (block[row] if row < len(block) else "").ljust(wide)
            for (_, block), wide in zip(line, widths, strict=True)
        ]
        yield GAP.join(parts).rstrip()
    yield ""
