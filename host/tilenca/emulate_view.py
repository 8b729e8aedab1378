"""Emulated tiles as a picture in the terminal: each its 7-segment digit, in its place and colour."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Group
from rich.text import Text

from tilenca.emulation import Emulation
from tilenca.glyphs import draw
from tilenca.shapes import Shape

TILE_WIDTH = 4  # three characters and a gap
SHAPE_GAP = "    "
ROWS_PER_TILE = 3


@dataclass(frozen=True)
class Picture:
    """What the tiles of a shape show at one moment, in the order of `shape.cells`."""

    shape: Shape
    segments: tuple[int, ...]
    colours: tuple[tuple[int, int, int], ...]


def take_picture(emulation: Emulation) -> Picture:
    """What the pins of all tiles say now."""
    tiles = list(emulation.array)
    return Picture(emulation.shape, tuple(t.segments for t in tiles), tuple(t.rgb for t in tiles))


def _style(colour: tuple[int, int, int]) -> str:
    """The LED's hue at full brightness: duties are small, so that real LEDs do not dazzle."""
    strongest = max(colour)
    if strongest == 0:
        return ""
    red, green, blue = (round(255 * duty / strongest) for duty in colour)
    return f"rgb({red},{green},{blue})"


def lines(picture: Picture) -> list[Text]:
    """The picture as lines of equal width."""
    cells = picture.shape.cells
    height, width = max(row for row, _ in cells) + 1, max(col for _, col in cells) + 1
    drawn = [[Text(" " * TILE_WIDTH) for _ in range(width)] for _ in range(height * ROWS_PER_TILE)]
    for (row, col), segments, colour in zip(cells, picture.segments, picture.colours, strict=True):
        for offset, part in enumerate(draw(segments)):
            # A dark tile is still there.
            text = part if segments else (" . " if offset == 1 else "   ")
            drawn[row * ROWS_PER_TILE + offset][col] = Text(f"{text} ", style=_style(colour))
    return [Text.assemble(*line) for line in drawn]


def beside(pictures: Sequence[Picture], room: int) -> Group:
    """Pictures next to each other, as many as fit into `room` characters, the rest below."""
    bands: list[list[list[Text]]] = [[]]
    for block in map(lines, pictures):
        used = sum(len(other[0]) + len(SHAPE_GAP) for other in bands[-1])
        if bands[-1] and used + len(block[0]) > room:
            bands.append([])
        bands[-1].append(block)
    output = []
    for band in bands:
        for number in range(max(len(block) for block in band)):
            parts = [block[number] if number < len(block) else Text(" " * len(block[0])) for block in band]
            line = Text(SHAPE_GAP).join(parts)
            line.rstrip()
            output.append(line)
        output.append(Text(""))
    return Group(*output)


def verdict(emulation: Emulation) -> str:
    """One line: whether the tiles are right, and since when."""
    name, count = emulation.shape.name, len(emulation.array)
    agreed_s = emulation.agreed_at_s()
    if agreed_s is not None:
        tiles = "the tile shows" if count == 1 else f"all {count} tiles show"
        return (
            f"{name}: {tiles} {emulation.shape.label}, since {agreed_s:.2f} s after the last was switched on "
            f"(update {emulation.agreed_at_update()})"
        )
    wrong = [
        f"tile {tile.index + 1} {emulation.shown(tile) or 'nothing'}"
        for tile in emulation.array
        if emulation.shown(tile) != emulation.shape.label
    ]
    total = f"{len(wrong)} of {count} tiles do not show {emulation.shape.label}"
    return f"{name}: WRONG, {total}: {', '.join(wrong)}"
