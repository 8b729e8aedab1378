"""Pictures become drawings: what is dark enough, or light enough, is tiles; the largest connected part stays.

numpy only; a file is opened by Pillow, which comes with matplotlib.
"""

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import UsageError
from tilenca.base.sides import OFFSETS
from tilenca.shapes.raster import Grid, rows_of_grid
from tilenca.shapes.sizes import Size
from tilenca.shapes.stretch import Rows

MOST_PIXELS = 40_000_000
# Pillow's exceptions, besides its own, on a picture with damaged bytes.
DAMAGED = (
    SyntaxError,
    ValueError,
    TypeError,
    LookupError,
    ArithmeticError,
    EOFError,
    struct.error,
    zlib.error,
)


def read_image(path: Path) -> NDArray[np.float64]:
    """The ink of a picture.

    Args:
        path: PNG, JPEG or any other format that Pillow reads.

    Returns:
        (rows, columns) float64, 0 for paper to 1 for ink; ink is dark, or light where most of it is dark.

    Raises:
        UsageError: it cannot be read, is too large, or is all of one colour.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            if image.width * image.height > MOST_PIXELS:
                raise UsageError(f"{path}: {image.width}x{image.height} pixels are too many; make it smaller")
            flat = Image.new("RGBA", image.size, "white")
            flat.alpha_composite(image.convert("RGBA"))
            grey = np.asarray(flat.convert("L"), np.float64) / 255
    except (UnidentifiedImageError, Image.DecompressionBombError, *DAMAGED) as error:
        raise UsageError(f"{path}: not a picture that can be read; save it as PNG") from error
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror or error}; give a picture, such as a PNG") from error
    low, high = float(grey.min()), float(grey.max())
    if high - low < 0.1:
        raise UsageError(f"{path}: all of one colour; draw with dark ink on light paper")
    ink = (high - grey) / (high - low)
    return 1 - ink if float(ink.mean()) > 0.5 else ink


def drawing_of(ink: NDArray[np.float64], size: Size, threshold: float = 0.5) -> Rows:
    """The drawing of a picture, trimmed.

    Args:
        ink: (rows, columns) 0..1.
        size: rows and columns of tiles that the whole picture is brought to.
        threshold: least mean ink of a tile.

    Returns:
        Rows of tiles; none where no tile has enough ink.
    """
    return rows_of_grid(largest_part(pooled(ink, size) >= threshold))


def cropped(ink: NDArray[np.float64], threshold: float = 0.5) -> NDArray[np.float64]:
    """The part of a picture that has ink."""
    rows, cols = (np.flatnonzero((ink >= threshold).any(axis=axis)) for axis in (1, 0))
    return ink[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1] if len(rows) else ink


def pooled(ink: NDArray[np.float64], size: Size) -> NDArray[np.float64]:
    """The mean ink of every tile, by area.

    Args:
        ink: (rows, columns).
        size: rows and columns wanted.
    """
    means = ink
    for wanted in size:  # rows first, then turned, columns
        sums = np.concatenate((np.zeros((1, means.shape[1])), np.cumsum(means, axis=0)))
        places = np.linspace(0, len(means), wanted + 1)
        low = np.minimum(places.astype(np.int64), len(means) - 1)
        upto = sums[low] + (places - low)[:, None] * means[low]
        means = (np.diff(upto, axis=0) * wanted / len(means)).T
    return means


def largest_part(grid: Grid) -> Grid:
    """The largest part that is connected by sides; the first of equal ones in reading order."""
    left = {(int(row), int(col)) for row, col in np.argwhere(grid)}
    best: set[tuple[int, int]] = set()
    for start in sorted(left):
        if start not in left:
            continue
        left.remove(start)
        part, front = {start}, [start]
        while front:
            row, col = front.pop()
            for down, right in OFFSETS:
                near = (row + down, col + right)
                if near in left:
                    left.remove(near)
                    part.add(near)
                    front.append(near)
        if len(part) > len(best):
            best = part
    found = np.zeros_like(grid)
    for row, col in best:
        found[row, col] = True
    return found
