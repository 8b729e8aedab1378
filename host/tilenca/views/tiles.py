"""Tiles as a picture in the terminal: each its 7-segment digit, in its place and colour."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.console import Console, Group
from rich.text import Text

from tilenca.shapes.file import Shape
from tilenca.shapes.glyphs import Duty, draw, label_of_glyph, screen_colour

# Box-drawing characters by their arms: 1 up, 2 right, 4 down, 8 left.
LIGHT = " ╵╶╰╷│╭├╴╯─┴╮┤┬┼"
HEAVY = " ╹╺┗╻┃┏┣╸┛━┻┓┫┳╋"
UP, RIGHT, DOWN, LEFT = 1, 2, 4, 8

TILE_WIDTH = 5
SHAPE_GAP = "  "
# A housing of its own, so that a digit can be read on any terminal's background.
HOUSING = "on rgb(28,28,28)"
DARK = "rgb(60,60,60)"
FRAME = f"rgb(88,88,88) {HOUSING}"


def shown_by(counts: Iterable[tuple[str, int]]) -> str:
    """How many tiles show what, like `5 show 4, 1 shows a dash`; the labels are in words."""
    return ", ".join(f"{count} show{'s' * (count == 1)} {label}" for label, count in counts)


@dataclass(frozen=True)
class Picture:
    """The displays of a shape's tiles at one moment, in the order of `shape.cells`."""

    shape: Shape
    segments: tuple[int, ...]
    colours: tuple[Duty, ...]


def led_style(duty: Duty) -> str:
    """The LED as a terminal shows it; dark where it is off."""
    if not any(duty):
        return HOUSING
    return f"{screen_style(duty)} {HOUSING}"


def screen_style(duty: Duty) -> str:
    """The LED's colour alone; a dark grey where it is off."""
    if not any(duty):
        return DARK
    red, green, blue = (round(255 * part) for part in screen_colour(duty))
    return f"rgb({red},{green},{blue})"


def digit(segments: int) -> tuple[str, str, str]:
    """Three rows of three characters: the lit segments as lines that meet at their ends."""
    a, b, c, d, e, f, g = (segments >> bit & 1 for bit in range(7))
    return (
        HEAVY[RIGHT * a + DOWN * f] + HEAVY[(LEFT + RIGHT) * a] + HEAVY[LEFT * a + DOWN * b],
        HEAVY[UP * f + RIGHT * g + DOWN * e]
        + HEAVY[(LEFT + RIGHT) * g]
        + HEAVY[UP * b + LEFT * g + DOWN * c],
        HEAVY[UP * e + RIGHT * d] + HEAVY[(LEFT + RIGHT) * d] + HEAVY[LEFT * d + UP * c],
    )


def framed(picture: Picture) -> list[Text]:
    """The picture as lines of equal width; tiles have a frame, and touching ones share its sides."""
    height, width = len(picture.shape.rows), len(picture.shape.rows[0])
    tiles = dict(zip(picture.shape.cells, zip(picture.segments, picture.colours, strict=True), strict=True))

    # Sides of tiles between the corners of the lattice: from (row, col) to the right, and downwards.
    def across(row: int, col: int) -> bool:
        return (row, col) in tiles or (row - 1, col) in tiles

    def down(row: int, col: int) -> bool:
        return (row, col) in tiles or (row, col - 1) in tiles

    def border(row: int) -> Text:
        line = Text()
        for col in range(width + 1):
            arms = UP * down(row - 1, col) + RIGHT * across(row, col)
            arms += DOWN * down(row, col) + LEFT * across(row, col - 1)
            line.append(LIGHT[arms], FRAME if arms else "")
            if col < width:
                drawn = across(row, col)
                line.append(LIGHT[(LEFT + RIGHT) * drawn] * TILE_WIDTH, FRAME if drawn else "")
        return line

    def inside(row: int, part: int) -> Text:
        line = Text()
        for col in range(width + 1):
            drawn = down(row, col)
            line.append(LIGHT[(UP + DOWN) * drawn], FRAME if drawn else "")
            if (row, col) in tiles:
                segments, colour = tiles[row, col]
                line.append(digit(segments)[part].center(TILE_WIDTH), led_style(colour))
            elif col < width:
                line.append(" " * TILE_WIDTH)
        return line

    lines = [
        line for row in range(height) for line in (border(row), *(inside(row, part) for part in range(3)))
    ]
    return [*lines, border(height)]


def compact(picture: Picture) -> list[Text]:
    """The picture without frames, in ASCII: for small terminals and old encodings."""
    height, width = len(picture.shape.rows), len(picture.shape.rows[0])
    drawn = [[Text("    ") for _ in range(width)] for _ in range(height * 3)]
    for (row, col), segments, colour in zip(
        picture.shape.cells, picture.segments, picture.colours, strict=True
    ):
        for part, text in enumerate(draw(segments) if segments else ("   ", " . ", "   ")):
            drawn[3 * row + part][col] = Text.assemble((text, led_style(colour)), " ")
    return [Text.assemble(*line) for line in drawn]


def letters(picture: Picture, known: tuple[str, ...] = (), ascii_only: bool = False) -> list[Text]:
    """A tile is two characters in a line: what it shows, in its colour; `known` labels tell 5 from S."""
    tiles = dict(zip(picture.shape.cells, zip(picture.segments, picture.colours, strict=True), strict=True))
    dark = "." if ascii_only else "·"
    lines = []
    for row in range(len(picture.shape.rows)):
        line = Text()
        for col in range(len(picture.shape.rows[0])):
            if (row, col) in tiles:
                segments, colour = tiles[row, col]
                line.append(f"{label_of_glyph(segments, known) or dark} ", led_style(colour))
            else:
                line.append("  ")
        lines.append(line)
    return lines


def half_blocks(picture: Picture) -> list[Text]:
    """Two tiles are one character, one above the other: their colours only; for the largest shapes."""
    tiles = dict(zip(picture.shape.cells, picture.colours, strict=True))
    lines = []
    for row in range(0, len(picture.shape.rows), 2):
        line = Text()
        for col in range(len(picture.shape.rows[0])):
            upper, lower = (
                screen_style(tiles[place]) if (place := (row + below, col)) in tiles else "default"
                for below in (0, 1)
            )
            if upper != "default":
                line.append("▀", f"{upper} on {lower}")
            else:
                line.append(" " if lower == "default" else "▄", lower)
        lines.append(line)
    return lines


def fitting(
    picture: Picture, width: int, height: int, ascii_only: bool, known: tuple[str, ...] = ()
) -> list[Text]:
    """The largest picture of one shape that fits: digits in frames, letters, or colours alone.

    Args:
        picture: what to show.
        width: characters in a line.
        height: lines that there are.
        ascii_only: whether there are no other characters.
        known: labels that tell "5" from "S".
    """
    sizes = [compact, letters] if ascii_only else [framed, letters, half_blocks]
    for draw_one in sizes:
        lines = letters(picture, known, ascii_only) if draw_one is letters else draw_one(picture)
        if len(lines) <= height and max(map(len, lines)) <= width:
            return lines
    return lines


def beside(pictures: Sequence[Picture], console: Console, width: int, height: int | None = None) -> Group:
    """Pictures next to each other, as many as fit into `width` characters, the rest below.

    Args:
        pictures: what to show.
        console: where; it decides which characters there are.
        width: characters in a line.
        height: lines that there are; None: as many as it takes.
    """
    blocks = list(map(framed, pictures))
    if console.options.ascii_only or (height is not None and max(map(len, blocks)) >= height):
        blocks = list(map(compact, pictures))
    bands: list[list[list[Text]]] = [[]]
    for block in blocks:
        used = sum(len(other[0]) + len(SHAPE_GAP) for other in bands[-1])
        if bands[-1] and used + len(block[0]) > width:
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
