"""Drawings that no training saw, on emulated tiles and in the simulator: python -m bench.unseen M=F [M=F].

Every drawing runs twice, as in `bench.pairs`: with the same clocks and moments of power. A run is right when
all tiles show the drawing's class after the last update. So a model's share of right drawings is measured on
the firmware itself, and the simulator that measures the model cards is held against it, drawing by drawing.
"""

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.pairs import Pairs, image_with, run_pairs
from bench.publish import publish
from tilenca.base import paths
from tilenca.base.errors import TilencaError, UsageError
from tilenca.commands.arguments import whole
from tilenca.emulator.translator import make
from tilenca.evaluation.metrics import wilson
from tilenca.shapes.batch import Drawings, load_drawings

BEGIN, END = "<!-- unseen: made by `python -m bench.unseen`, do not edit -->", "<!-- /unseen -->"


@dataclass(frozen=True)
class Asked:
    """A model and the file of drawings that it is asked."""

    model: str
    file: Path


def asked(text: str) -> Asked:
    """Reads MODEL=FILE.

    Raises:
        argparse.ArgumentTypeError: it is not of that form, or there is no such file.
    """
    model, equals, file = text.partition("=")
    if not (model and equals and Path(file).is_file()):
        raise argparse.ArgumentTypeError(f"'{text}' is not MODEL=FILE with a file that is there")
    return Asked(model, Path(file))


def some(drawings: Drawings, count: int) -> Drawings:
    """So many of them, evenly from all over the file; all, where it has no more."""
    count = min(count, len(drawings))
    chosen = [number * len(drawings) // count for number in range(count)]
    return replace(
        drawings,
        shapes=tuple(drawings.shapes[number] for number in chosen),
        groups=tuple(drawings.groups[number] for number in chosen),
    )


def row(name: str, drawings: Drawings, pairs: Pairs) -> str:
    """A row of the table in Markdown."""
    tiles, simulator = np.isfinite(pairs.tiles), np.isfinite(pairs.simulator)
    cells = [f"`{name}`", f"{len(drawings)}", f"{drawings.sizes.min()} to {drawings.sizes.max()}"]
    for right in (tiles, simulator):
        low, high = wilson(int(right.sum()), len(right))
        cells.append(f"{right.mean():.3f} ({low:.3f} to {high:.3f})")
    only = (int((tiles & ~simulator).sum()), int((simulator & ~tiles).sum()))
    cells += [f"{np.mean(tiles == simulator):.3f}", f"{only[0]}, {only[1]}"]
    return f"| {' | '.join(cells)} |"


def measure(one: Asked, count: int, updates: int, seed: int) -> str:
    """Runs one model, and says what came of it as a row.

    Raises:
        TilencaError: see `image_with`, `load_drawings`, `bench.pairs.emulate`.
    """
    folder = paths.MODELS / one.model
    if not folder.is_dir():
        raise UsageError(f"there is no models/{one.model}")
    image = image_with(folder)
    drawings = some(load_drawings([one.file], labels=image.model.labels), count)
    make(image.elf)
    return row(one.model, drawings, run_pairs(image, drawings, len(drawings), seed, updates))


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="Drawings that no training saw, on emulated tiles.")
    parser.add_argument("asked", nargs="+", type=asked, metavar="MODEL=FILE", help="what to ask of what")
    parser.add_argument(
        "--drawings", type=whole(1), default=50, help="of each file, from all over it (default: %(default)s)"
    )
    parser.add_argument("--updates", type=whole(1), default=100, help="of a run (default: %(default)s)")
    parser.add_argument("--seed", type=whole(0), default=1, help="of all runs (default: %(default)s)")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    args = parser.parse_args()
    rows = [
        "| model | drawings | tiles | emulated tiles: right | simulator: right | both say the same "
        "| only the tiles right, only the simulator |",
        "|---|---|---|---|---|---|---|",
    ]
    try:
        rows += [measure(one, args.drawings, args.updates, args.seed) for one in args.asked]
    except TilencaError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    publish("\n".join(rows), args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
