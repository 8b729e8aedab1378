"""A film of tiles as one picture of all steps, or as an animated GIF. Needs matplotlib."""

import io
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.glyphs import SEGMENT_NAMES, look_of_class, screen_colour
from tilenca.simulator.trace import NOTHING, Film
from tilenca.views.plots import FAINT, INK, WIDTH_IN, save, styled, unwritable

# After plots, which names the remedy where matplotlib is missing.
from matplotlib.axes import Axes  # isort: skip
from matplotlib.collections import PolyCollection  # isort: skip
from matplotlib.figure import Figure  # isort: skip
from matplotlib.patches import FancyBboxPatch  # isort: skip
from PIL import Image  # isort: skip

MAX_PANELS = 24
TILE_IN, GAP_IN, TITLE_IN, CAPTION_IN, MARGIN_IN = 0.3, 0.32, 0.72, 0.45, 0.15
LEAST_PANEL_IN = 0.85
LEAST_COLUMNS = 5
GIF_TILE_IN, GIF_WIDTH_IN, GIF_CAPTION_IN, GIF_DPI = 0.5, 2.4, 0.4, 100
FRAME_MS, LAST_FRAME_MS = 400, 2500

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


def draw_tiles(axes: Axes, film: Film, step: int) -> None:
    """Fills axes with the tiles at a step, coloured by the digits they show; dark where there is none."""
    digits: dict[str, list[list[Point]]] = {INK: [], WHITE: []}
    for (row, col), shown in zip(film.shape.cells, film.shown[step], strict=True):
        fill: tuple[float, float, float] | str = DARK
        edge: tuple[float, ...] | str = DARK_EDGE
        if shown != NOTHING:
            look = look_of_class(film.labels, int(shown))
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
    axes.set_xlim(0, len(film.shape.rows[0]))
    axes.set_ylim(len(film.shape.rows), 0)
    axes.set_axis_off()


def _panel(figure: Figure, place: tuple[float, float], tile_in: float, film: Film, step: int) -> None:
    """The tiles at one step; `place` is their upper left corner in inches from that of the figure."""
    width, height = figure.get_size_inches()
    wide, high = tile_in * len(film.shape.rows[0]), tile_in * len(film.shape.rows)
    left, top = place
    axes = figure.add_axes((left / width, 1 - (top + high) / height, wide / width, high / height))
    draw_tiles(axes, film, step)


def _caption(figure: Figure, place: tuple[float, float], film: Film, step: int) -> None:
    """The step's number, ticked off if every tile is right; `place` is the text's middle in inches."""
    width, height = figure.get_size_inches()
    right = bool(film.right[step])
    figure.text(
        place[0] / width,
        1 - place[1] / height,
        f"step {step} \N{CHECK MARK}" if right else f"step {step}",
        ha="center",
        va="center",
        fontsize=9,
        fontweight="bold" if right else "normal",
    )


def _title(figure: Figure, film: Film) -> None:
    width, height = figure.get_size_inches()
    agreed = film.agreed_at
    verdict = (
        f"every tile right from step {agreed}" if agreed is not None else "not every tile right at the end"
    )
    figure.text(
        MARGIN_IN / width,
        1 - 0.26 / height,
        f"\N{LEFT DOUBLE QUOTATION MARK}{film.shape.label}\N{RIGHT DOUBLE QUOTATION MARK}: {verdict}",
        fontsize=13,
        fontweight="bold",
        va="center",
    )
    figure.text(
        MARGIN_IN / width,
        1 - 0.5 / height,
        film.about,
        fontsize=9,
        color=FAINT,
        va="center",
    )


def panels_of(steps: int) -> NDArray[np.int64]:
    """The steps that a picture shows: all, or as many as fit, denser at the beginning."""
    if steps < MAX_PANELS:
        return np.arange(steps + 1)
    return np.unique((np.linspace(0, 1, MAX_PANELS) ** 2 * steps).round().astype(np.int64))


def draw_strip(film: Film, path: Path) -> int:
    """Draws the steps of a film side by side, as PNG or SVG; returns how many.

    Raises:
        TilencaError: see `tilenca.views.plots.save`.
    """
    steps = panels_of(len(film.shown) - 1)
    rows, cols = len(film.shape.rows), len(film.shape.rows[0])
    usable = WIDTH_IN - 2 * MARGIN_IN + GAP_IN
    tile_in = min(TILE_IN, (usable / LEAST_COLUMNS - GAP_IN) / cols)
    wide, high = max(tile_in * cols + GAP_IN, LEAST_PANEL_IN), tile_in * rows + CAPTION_IN
    bands = math.ceil(len(steps) / int(usable / wide))
    across = math.ceil(len(steps) / bands)
    with styled():
        figure = Figure(figsize=(WIDTH_IN, TITLE_IN + bands * high))
        # The rest of the width goes between the panels.
        spread = usable / across
        _title(figure, film)
        for number, step in enumerate(steps):
            middle = MARGIN_IN + (number % across) * spread + (spread - GAP_IN) / 2
            top = TITLE_IN + (number // across) * high
            _panel(figure, (middle - tile_in * cols / 2, top), tile_in, film, int(step))
            _caption(figure, (middle, top + tile_in * rows + 0.15), film, int(step))
        save(figure, path)
    return len(steps)


def draw_gif(film: Film, path: Path) -> int:
    """Draws every step of a film as a frame of an animated GIF, which repeats for ever; returns how many.

    Raises:
        TilencaError: see `tilenca.views.plots.save`.
    """
    frames = []
    with styled():
        for step in range(len(film.shown)):
            frames.append(_frame(film, step))
    times = [FRAME_MS] * (len(frames) - 1) + [LAST_FRAME_MS]
    try:
        frames[0].save(path, save_all=True, append_images=frames[1:], duration=times, loop=0)
    except OSError as error:
        raise unwritable(path, error) from error
    return len(frames)


def _frame(film: Film, step: int) -> Image.Image:
    rows, cols = len(film.shape.rows), len(film.shape.rows[0])
    width = max(GIF_TILE_IN * cols + 2 * MARGIN_IN, GIF_WIDTH_IN)
    figure = Figure(figsize=(width, GIF_TILE_IN * rows + GIF_CAPTION_IN + MARGIN_IN), dpi=GIF_DPI)
    _caption(figure, (width / 2, GIF_CAPTION_IN / 2), film, step)
    _panel(figure, ((width - GIF_TILE_IN * cols) / 2, GIF_CAPTION_IN), GIF_TILE_IN, film, step)
    with io.BytesIO() as png:
        figure.savefig(png, format="png")
        return Image.open(png).convert("RGB").quantize(method=Image.Quantize.MEDIANCUT)
