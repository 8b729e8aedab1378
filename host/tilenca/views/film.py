"""A film of tiles as one picture of all steps, or as an animated GIF. Needs matplotlib."""

import io
import math
from collections.abc import Iterator
from pathlib import Path

from tilenca.shapes.glyphs import SEGMENT_NAMES, screen_colour
from tilenca.views.plots import FAINT, INK, WIDTH_IN, save, styled, unwritable
from tilenca.views.reel import Reel

# After plots, which names the remedy where matplotlib is missing.
from matplotlib.axes import Axes  # isort: skip
from matplotlib.collections import PolyCollection  # isort: skip
from matplotlib.figure import Figure  # isort: skip
from matplotlib.patches import FancyBboxPatch  # isort: skip
from PIL import Image, ImageChops  # isort: skip
from PIL.GifImagePlugin import getdata, getheader  # isort: skip

MAX_PANELS = 24
TILE_IN, GAP_IN, TITLE_IN, CAPTION_IN, MARGIN_IN = 0.3, 0.32, 0.72, 0.45, 0.15
LEAST_PANEL_IN = 0.85
LEAST_COLUMNS = 5
CHARACTER_EM = 0.6  # a character is no wider in the mean
GIF_TILE_IN, GIF_WIDEST_IN, GIF_TALLEST_IN = 0.7, 7.0, 14.0
GIF_WIDTH_IN, GIF_CAPTION_IN, GIF_DPI = 5.2, 0.4, 100
CLEAR = 255  # the index of what stays as it was

DARK, DARK_EDGE = "#3a3f47", "#2b2f36"
WHITE = "#ffffff"
BRIGHT = 0.25  # a tile's luminance from which its digit is written dark

# The middle line of each segment in a tile of 1 by 1, y downwards; `THICK` is half the width of the line.
LEFT, RIGHT, TOP, MIDDLE, BOTTOM, THICK = 0.32, 0.68, 0.2, 0.5, 0.8, 0.052
SEGMENT_LINES = {
    "a": ((LEFT, TOP), (RIGHT, TOP)),
    "b": ((RIGHT, TOP), (RIGHT, MIDDLE)),
    "c": ((RIGHT, MIDDLE), (RIGHT, BOTTOM)),
    "d": ((LEFT, BOTTOM), (RIGHT, BOTTOM)),
    "e": ((LEFT, MIDDLE), (LEFT, BOTTOM)),
    "f": ((LEFT, TOP), (LEFT, MIDDLE)),
    "g": ((LEFT, MIDDLE), (RIGHT, MIDDLE)),
}
CLEARANCE = 0.012  # between two segments that meet

Point = tuple[float, float]


def segment(name: str) -> list[Point]:
    """The six corners of a segment, pointed at both ends, in a tile of 1 by 1 with y downwards."""
    (x0, y0), (x1, y1) = SEGMENT_LINES[name]
    along = ((x1 > x0) * 1.0, (y1 > y0) * 1.0)
    across = (along[1] * THICK, along[0] * THICK)
    x0, y0 = x0 + along[0] * CLEARANCE, y0 + along[1] * CLEARANCE
    x1, y1 = x1 - along[0] * CLEARANCE, y1 - along[1] * CLEARANCE
    near = x0 + along[0] * THICK, y0 + along[1] * THICK
    far = x1 - along[0] * THICK, y1 - along[1] * THICK
    return [
        (x0, y0),
        (near[0] + across[0], near[1] + across[1]),
        (far[0] + across[0], far[1] + across[1]),
        (x1, y1),
        (far[0] - across[0], far[1] - across[1]),
        (near[0] - across[0], near[1] - across[1]),
    ]


def luminance(colour: tuple[float, float, float]) -> float:
    """The luminance (0..1) of a colour (RGB, 0..1 each)."""
    red, green, blue = (math.pow(part, 2.2) for part in colour)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def draw_tiles(axes: Axes, reel: Reel, number: int) -> None:
    """Fills axes with the tiles of a picture, coloured by the digits they show; dark where there is none."""
    digits: dict[str, list[list[Point]]] = {INK: [], WHITE: []}
    for (row, col), look in zip(reel.cells, reel.pictures[number].looks, strict=True):
        if look is None:
            continue
        fill: tuple[float, float, float] | str = DARK
        edge: tuple[float, ...] | str = DARK_EDGE
        if look.label:
            fill = screen_colour(look.colour)
            edge = tuple(0.72 * part for part in fill)
            ink = INK if luminance(fill) > BRIGHT else WHITE
            for bit, name in enumerate(SEGMENT_NAMES):
                if look.segments >> bit & 1:
                    digits[ink].append([(col + x, row + y) for x, y in segment(name)])
        axes.add_patch(
            FancyBboxPatch(
                (col + 0.07, row + 0.07),
                0.86,
                0.86,
                boxstyle="round,pad=0,rounding_size=0.12",
                facecolor=fill,
                edgecolor=edge,
                linewidth=0.7,
            )
        )
    for ink, polygons in digits.items():
        axes.add_collection(PolyCollection(polygons, facecolor=ink, edgecolor="none", zorder=3))
    rows, cols = reel.size
    axes.set_xlim(0, cols)
    axes.set_ylim(rows, 0)
    axes.set_axis_off()


def _panel(figure: Figure, place: Point, tile_in: float, reel: Reel, number: int) -> None:
    """The tiles of one picture; `place` is their upper left corner in inches from that of the figure."""
    width, height = figure.get_size_inches()
    rows, cols = reel.size
    wide, high = tile_in * cols, tile_in * rows
    left, top = place
    axes = figure.add_axes((left / width, 1 - (top + high) / height, wide / width, high / height))
    draw_tiles(axes, reel, number)


def _caption(figure: Figure, place: Point, reel: Reel, number: int) -> None:
    """The time, ticked off if all tiles agree; `place` is the text's middle in inches."""
    width, height = figure.get_size_inches()
    picture = reel.pictures[number]
    figure.text(
        place[0] / width,
        1 - place[1] / height,
        f"{picture.caption} \N{CHECK MARK}" if picture.agreed else picture.caption,
        ha="center",
        va="center",
        fontsize=9,
        fontweight="bold" if picture.agreed else "normal",
    )


def _title(figure: Figure, reel: Reel) -> None:
    width, height = figure.get_size_inches()
    room = 72 * (width - 2 * MARGIN_IN) / CHARACTER_EM
    for text, top, size, weight, colour in (
        (reel.title, 0.26, 13.0, "bold", INK),
        (reel.about, 0.5, 9.0, "normal", FAINT),
    ):
        figure.text(
            MARGIN_IN / width,
            1 - top / height,
            text,
            va="center",
            fontsize=min(size, room / len(text)),
            fontweight=weight,
            color=colour,
        )


def panels_of(reel: Reel) -> list[int]:
    """The pictures that a strip shows: all, or as many as fit of those in which something is new.

    The first, the last, and the one from which all agree are among them, and where there are few such, those
    in which all agree for the first time.
    """
    last = len(reel.pictures) - 1
    if last < MAX_PANELS:
        return list(range(last + 1))
    kept = {0, last} if reel.agreed_at is None else {0, last, reel.agreed_at}
    agreed = [picture.agreed for picture in reel.pictures]
    begins = {number for number in range(1, last) if agreed[number] and not agreed[number - 1]}
    if len(begins) <= MAX_PANELS // 4:
        kept |= begins
    eventful = [number for number in reel.eventful if number not in kept]
    room = MAX_PANELS - len(kept)
    if len(eventful) > room:
        eventful = [eventful[place * len(eventful) // room] for place in range(room)]
    return sorted([*kept, *eventful])


def draw_strip(reel: Reel, path: Path) -> int:
    """Draws the pictures of a film side by side, as PNG or SVG; returns how many.

    Raises:
        TilencaError: see `tilenca.views.plots.save`.
    """
    chosen = panels_of(reel)
    rows, cols = reel.size
    usable = WIDTH_IN - 2 * MARGIN_IN + GAP_IN
    tile_in = min(TILE_IN, (usable / LEAST_COLUMNS - GAP_IN) / cols)
    wide, high = max(tile_in * cols + GAP_IN, LEAST_PANEL_IN), tile_in * rows + CAPTION_IN
    bands = math.ceil(len(chosen) / int(usable / wide))
    across = math.ceil(len(chosen) / bands)
    with styled():
        figure = Figure(figsize=(WIDTH_IN, TITLE_IN + bands * high))
        # The rest of the width goes between the panels.
        spread = usable / across
        _title(figure, reel)
        for place, number in enumerate(chosen):
            middle = MARGIN_IN + (place % across) * spread + (spread - GAP_IN) / 2
            top = TITLE_IN + (place // across) * high
            _panel(figure, (middle - tile_in * cols / 2, top), tile_in, reel, number)
            _caption(figure, (middle, top + tile_in * rows + 0.15), reel, number)
        save(figure, path)
    return len(chosen)


def draw_gif(reel: Reel, path: Path) -> int:
    """Draws every picture of a film as a frame of an animated GIF, which repeats for ever; returns how many.

    However long the film is, no more than two frames are held at a time.

    Raises:
        TilencaError: see `tilenca.views.plots.save`.
    """
    try:
        with styled(), path.open("wb") as file:
            before: Image.Image | None = None
            for number, picture in enumerate(reel.pictures):
                frame = _frame(reel, number)
                file.writelines(_encoded(frame, before, round(1000 * picture.seconds)))
                before = frame
            file.write(b";")
    except OSError as error:
        raise unwritable(path, error) from error
    return len(reel.pictures)


def _encoded(frame: Image.Image, before: Image.Image | None, milliseconds: int) -> Iterator[bytes]:
    """A frame of a GIF: its head and the first one, or what is new since the one before."""
    if before is None:
        first = frame.quantize(method=Image.Quantize.MEDIANCUT)
        head, _ = getheader(first, info={"loop": 0, "duration": milliseconds})
        yield from head
        yield from getdata(first, duration=milliseconds)
        return
    red, green, blue = ImageChops.difference(frame, before).split()
    change = ImageChops.lighter(ImageChops.lighter(red, green), blue)
    box = change.getbbox() or (0, 0, 1, 1)
    part = frame.crop(box).quantize(CLEAR, Image.Quantize.MEDIANCUT)
    colours = part.getpalette() or []
    part.putpalette(colours + [0] * (3 * (CLEAR + 1) - len(colours)))
    part.paste(CLEAR, mask=change.crop(box).point([255] + [0] * 255))
    yield from getdata(
        part, box[:2], duration=milliseconds, transparency=CLEAR, disposal=1, include_color_table=True
    )


def _frame(reel: Reel, number: int) -> Image.Image:
    rows, cols = reel.size
    tile_in = min(GIF_TILE_IN, GIF_WIDEST_IN / cols, GIF_TALLEST_IN / rows)
    width = max(tile_in * cols + 2 * MARGIN_IN, GIF_WIDTH_IN)
    top = TITLE_IN + GIF_CAPTION_IN
    figure = Figure(figsize=(width, top + tile_in * rows + MARGIN_IN), dpi=GIF_DPI)
    _title(figure, reel)
    _caption(figure, (width / 2, TITLE_IN + GIF_CAPTION_IN / 3), reel, number)
    _panel(figure, ((width - tile_in * cols) / 2, top), tile_in, reel, number)
    with io.BytesIO() as png:
        figure.savefig(png, format="png")
        return Image.open(png).convert("RGB")
