"""Writes shape files of handwritten digits: `python -m handwriting OUT`.

`SOURCE-held-out.toml` has the drawings that nothing is trained on, `SOURCE.toml` the others, and each of
those again several times, warped a little. `sources.py` says which packages bring them.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from handwriting.sources import SOURCES, Ink, Source
from tilenca.base.errors import UsageError
from tilenca.shapes.file import shape_table
from tilenca.shapes.image import drawing_of
from tilenca.shapes.stretch import Rows

LEAST_TILES = 8
TURN, SLANT, SCALE, SHIFT = 12.0, 0.2, 0.12, 0.06


def warped(ink: Ink, random: np.random.Generator) -> Ink:
    """The picture turned, slanted, scaled and shifted by chance, by bilinear interpolation."""
    turn = np.radians(random.uniform(-TURN, TURN))
    matrix = np.array(((np.cos(turn), -np.sin(turn)), (np.sin(turn), np.cos(turn))))
    matrix = matrix @ np.array(((1.0, 0.0), (random.uniform(-SLANT, SLANT), 1.0)))
    matrix = matrix @ np.diag(1 + random.uniform(-SCALE, SCALE, 2))
    middle = (np.array(ink.shape) - 1) / 2
    shift = random.uniform(-SHIFT, SHIFT, 2) * ink.shape
    places = np.stack(np.meshgrid(*map(np.arange, ink.shape), indexing="ij"), axis=-1) - middle
    row, col = np.moveaxis(places @ matrix.T + middle + shift, -1, 0)
    padded = np.pad(ink, 1)
    row, col = (
        np.clip(place + 1, 0, side - 1.001) for place, side in zip((row, col), padded.shape, strict=True)
    )
    top, left = row.astype(np.int64), col.astype(np.int64)
    down, right = row - top, col - left
    upper = (1 - right) * padded[top, left] + right * padded[top, left + 1]
    lower = (1 - right) * padded[top + 1, left] + right * padded[top + 1, left + 1]
    new: Ink = (1 - down) * upper + down * lower
    return new


def copies(ink: Ink, source: Source, random: np.random.Generator) -> Iterator[Rows]:
    """The drawing of a picture, and of the warped ones."""
    yield drawing_of(ink, source.size, source.threshold)
    for _ in range(source.copies):
        yield drawing_of(warped(ink, random), source.size, random.uniform(*source.inks))


def shape_file(title: str, drawings: dict[Rows, str], sizes: str = "") -> str:
    """The text of a shape file, with a table of sizes if it has one."""
    tables = (shape_table(label, rows) for rows, label in drawings.items())
    return "\n".join((f"# {title}\n\nvary = false\n{sizes}", *tables))


def split(source: Source, random: np.random.Generator) -> tuple[dict[Rows, str], dict[Rows, str]]:
    """The drawings to train on and the ones held out, with their labels; no drawing is in both."""
    pictures, digits = source.load()
    held = source.held_out(digits)
    last = {
        drawing_of(ink, source.size, source.threshold): str(digit)
        for ink, digit in zip(pictures[held], digits[held], strict=True)
    }
    trained: dict[Rows, str] = {}
    for ink, digit in zip(pictures[~held], digits[~held], strict=True):
        for rows in copies(ink, source, random):
            if rows not in last and sum(row.count("#") for row in rows) >= LEAST_TILES:
                trained.setdefault(rows, str(digit))
    return trained, last


def main() -> int:
    """Writes the two files."""
    parser = argparse.ArgumentParser(prog="python -m handwriting", description=__doc__.partition("\n")[0])
    parser.add_argument("out", type=Path, help="folder of the two files")
    parser.add_argument("--source", choices=SOURCES, default="mnist", help="whose digits (mnist)")
    parser.add_argument("--seed", type=int, default=1, help="of the warped copies (1)")
    args = parser.parse_args()
    source = SOURCES[args.source]
    try:
        trained, last = split(source, np.random.default_rng(args.seed))
    except UsageError as error:
        parser.error(str(error))
    args.out.mkdir(parents=True, exist_ok=True)
    name, file = args.source, f"{args.source}-held-out.toml"
    sizes = f'\n[sizes]\nmeasured = ["{file}"]\n'
    first = shape_file(f"{source.title}, and copies of them, warped.", trained, sizes)
    (args.out / f"{name}.toml").write_text(first)
    (args.out / file).write_text(shape_file(f"{source.title}, never trained on.", last))
    print(f"{len(trained)} drawings to train on, {len(last)} held out, in {args.out}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
