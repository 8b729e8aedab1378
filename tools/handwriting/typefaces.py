"""Writes a shape file of digits of typefaces: `python -m handwriting.typefaces OUT`.

matplotlib brings the typefaces. Each digit is drawn large, cropped, and brought to every height from 8 to 12
tiles; drawings that fall apart at a height are left out.
"""

import argparse
import sys
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from handwriting.__main__ import shape_file
from handwriting.sources import Ink
from tilenca.shapes.image import cropped, drawing_of, pooled
from tilenca.shapes.stretch import Rows

FONTS = (
    "DejaVuSans", "DejaVuSans-Bold", "DejaVuSans-Oblique", "DejaVuSansMono", "DejaVuSerif", "STIXGeneral",
    "cmr10", "cmss10",
)  # fmt: skip
HEIGHTS = range(8, 13)
POINTS = 200
INK = 0.45  # mean ink of a tile


def digit(font: ImageFont.FreeTypeFont, text: str) -> Ink:
    """(rows, columns) ink 0..1 of a character, cropped."""
    image = Image.new("L", (2 * POINTS, 2 * POINTS))
    ImageDraw.Draw(image).text((POINTS // 2, POINTS // 4), text, fill=255, font=font)
    return cropped(np.asarray(image, np.float64) / 255)


def drawings() -> dict[Rows, str]:
    """All of them, with their labels; what two digits share is left out."""
    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    found: dict[Rows, str] = {}
    shared = set()
    for name in FONTS:
        font = ImageFont.truetype(folder / f"{name}.ttf", POINTS)
        for label in "0123456789":
            ink = digit(font, label)
            for height in HEIGHTS:
                size = height, max(1, round(height * ink.shape[1] / ink.shape[0]))
                rows = drawing_of(ink, size, INK)
                whole = sum(row.count("#") for row in rows) == int((pooled(ink, size) >= INK).sum())
                if rows and whole and found.setdefault(rows, label) != label:
                    shared.add(rows)
    return {rows: label for rows, label in found.items() if rows not in shared}


def main() -> int:
    """Writes the file."""
    prog, first = "python -m handwriting.typefaces", __doc__.partition("\n")[0]
    parser = argparse.ArgumentParser(prog=prog, description=first)
    parser.add_argument("out", type=Path, help="folder of typefaces.toml")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    found = drawings()
    title = "Digits of typefaces that matplotlib brings, 8 to 12 tiles high."
    (args.out / "typefaces.toml").write_text(shape_file(title, found))
    print(f"{len(found)} drawings in {args.out / 'typefaces.toml'}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
