"""`tilenca shapes`: draws and checks a shape file, and what its classes may become, without any training."""

import argparse
import json
import shlex
import shutil
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.base.shipped import shapes_file, shapes_names
from tilenca.base.stdio import warn
from tilenca.commands.arguments import number, seed, size, whole
from tilenca.model.file import DEFAULT_CHANNELS, Dimensions
from tilenca.shapes.advice import advice
from tilenca.shapes.batch import Drawings, load_training_task
from tilenca.shapes.file import Shape, Task, load_task, shape_table, too_large
from tilenca.shapes.glyphs import GLYPHS, SEGMENT_NAMES
from tilenca.shapes.image import cropped, drawing_of, pooled, read_image
from tilenca.shapes.sizes import LARGEST, Size
from tilenca.shapes.stretch import Rows
from tilenca.shapes.variant import LAST, TRAINED
from tilenca.views.drawings import half_blocks, side_by_side
from tilenca.views.tiles import digit

IMAGE_ROWS = 10
DIGIT_WIDTH, DIGIT_GAP = 3, "  "
INK = (0.5, 0.4, 0.3, 0.2, 0.12)  # least part of a tile that is ink, as far as needed
MOST_DROPPED = 0.05  # of the drawing's tiles may be left out, before less ink will do


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "shapes",
        type=shapes_file,
        nargs="?",
        default=paths.DEFAULT_SHAPES,
        metavar="FILE",
        help=f"a shape file, or one of: {' '.join(shapes_names())} (digits)",
    )
    parser.add_argument(
        "--vary",
        type=whole(1, 1000),
        nargs="?",
        const=8,
        metavar="N",
        help="draw N variants of every class too, as training draws them (8)",
    )
    parser.add_argument(
        "--held-out", action="store_true", help="with --vary: variants of forms that training never sees"
    )
    parser.add_argument("--toml", action="store_true", help="with --vary: print the variants as a shape file")
    parser.add_argument(
        "--seed", type=seed, default=1, metavar="N", help="same seed, same variants (default 1)"
    )
    picture = parser.add_argument_group("picture", "instead: a picture becomes a drawing")
    picture.add_argument(
        "--image",
        type=Path,
        metavar="FILE",
        help="a picture of one sign, such as a PNG: dark ink on light paper, or light on dark; the largest "
        "connected part becomes a [[shape]] table, to add to a shape file",
    )
    picture.add_argument("--size", type=size, metavar="RxC", help=f"rows x columns ({IMAGE_ROWS} rows)")
    picture.add_argument(
        "--label",
        choices=list(GLYPHS),
        default="-",
        metavar="L",
        help="what it means (-: none of the others)",
    )
    picture.add_argument(
        "--ink",
        type=number(0, 1),
        metavar="P",
        help="least part of a tile that is ink, 0 to 1 (0.5, or less where the drawing would fall apart)",
    )
    parser.add_argument("--json", action="store_true", help="print the result as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Draws, and says what to know before training."""
    if args.image is not None:
        return _image(args)
    if (args.held_out or args.toml) and not args.vary:
        raise UsageError("--held-out and --toml are about variants; add --vary")
    task = load_task(args.shapes)
    problems = _problems(task)
    variants: dict[str, list[Rows]] = {}
    if args.vary or too_large(task.shapes) is None:
        drawings, _ = load_training_task([args.shapes], 1.0, len(task.labels))
        variants = _variants(drawings, args) if args.vary else {}
    if args.toml:
        which = "of forms held out from training" if args.held_out else "as training draws them"
        print(f"# Variants of {args.shapes.name}, {which}, seed {args.seed}.\n\nvary = false\n")
        print("\n".join(shape_table(label, rows) for label, some in variants.items() for rows in some))
        return 0
    if args.json:
        report: dict[str, Any] = {
            "shapes": [_entry(shape) for shape in task.shapes],
            "problems": problems,
            "advice": list(advice(task)),
        }
        if args.vary:
            report["variants"] = {
                label: ["\n".join(rows) for rows in some] for label, some in variants.items()
            }
        print(json.dumps(report))
        return 0
    width = shutil.get_terminal_size().columns
    titled = [(f"{s.name} {len(s.rows)}x{len(s.rows[0])}", s.rows) for s in task.shapes]
    print("\n".join(side_by_side(titled, width)))
    for label, some in variants.items():
        print(f"{label} may become")
        print("\n".join(side_by_side([("", rows) for rows in some], width)))
    drawn = f"{len(task.shapes)} drawing{'s' * (len(task.shapes) > 1)}"
    print(f"{drawn} of {len(task.labels)} class{'es' * (len(task.labels) > 1)}: {' '.join(task.labels)}")
    print(f"tiles will show\n{_displays(task.labels, width)}")
    for sentence in advice(task):
        print(fill(sentence, width, subsequent_indent="  ", break_long_words=False))
    for problem in problems:
        print(problem)
    if not problems and args.shapes.suffix == ".toml" and args.shapes.parent != paths.SHAPES:
        warn(f"next: tilenca make {shlex.quote(str(args.shapes))}")
    return 0


def _displays(labels: Sequence[str], width: int) -> str:
    """The labels as the tiles' digits, as many beside each other as there is room for."""
    each = max(1, width // (DIGIT_WIDTH + len(DIGIT_GAP)))
    rows = [labels[first : first + each] for first in range(0, len(labels), each)]
    return "\n".join(
        DIGIT_GAP.join(part).rstrip()
        for row in rows
        for part in zip(*(digit(GLYPHS[label]) for label in row), strict=True)
    )


def _image(args: argparse.Namespace) -> int:
    """Prints the drawing of a picture as a table of a shape file, and shows it."""
    ink = cropped(read_image(args.image))
    size = args.size or _kept_proportions(ink.shape)
    rows: Rows = ()
    dropped = 0
    # Thin strokes leave little ink in a tile: take less of it until the drawing is whole.
    for least in (args.ink,) if args.ink is not None else INK:
        rows = drawing_of(ink, size, least)
        dropped = int((pooled(ink, size) >= least).sum()) - sum(row.count("#") for row in rows)
        if rows and dropped <= MOST_DROPPED * sum(row.count("#") for row in rows):
            break
    if not rows:
        raise UsageError(f"{args.image}: no tile has that much ink; give a smaller --ink, or another --size")
    grid = "\n".join(rows)
    if args.json:
        print(json.dumps({"label": args.label, "rows": len(rows), "cols": len(rows[0]), "grid": grid}))
        return 0
    warn("\n".join(half_blocks(rows)))
    if dropped:
        warn(f"note: {dropped} tiles with ink do not touch the others and are left out; try a smaller --ink")
    warn(f"{grid.count('#')} tiles in {len(rows)} rows and {len(rows[0])} columns; add this to a shape file:")
    print(shape_table(args.label, rows), end="")
    return 0


def _kept_proportions(pixels: tuple[int, ...]) -> Size:
    return IMAGE_ROWS, max(1, min(LARGEST, round(IMAGE_ROWS * pixels[1] / pixels[0])))


def _entry(shape: Shape) -> dict[str, Any]:
    lit = [name for bit, name in enumerate(SEGMENT_NAMES) if GLYPHS[shape.label] >> bit & 1]
    return {
        "label": shape.label,
        "rows": len(shape.rows),
        "cols": len(shape.rows[0]),
        "tiles": len(shape.cells),
        "display": "".join(lit),
    }


def _variants(drawings: Drawings, args: argparse.Namespace) -> dict[str, list[Rows]]:
    """Some variants of every class, as training draws them or of forms that it never sees."""
    if drawings.variants is None:
        raise UsageError(
            f"{args.shapes}: has areas or says vary = false, so its classes are just its drawings; leave "
            "--vary out"
        )
    random, split = np.random.default_rng(args.seed), LAST if args.held_out else TRAINED
    found = {
        label: drawings.variants.some(label, args.vary, random, args.shapes, split)
        for label in drawings.labels
    }
    classes = Counter(rows for some in found.values() for rows in set(some))
    if doubtful := sum(count > 1 for count in classes.values()):
        what = "1 drawing was" if doubtful == 1 else f"{doubtful} drawings were"
        warn(f"note: {what} drawn for two classes and left out, as in training")
    return {label: [rows for rows in some if classes[rows] == 1] for label, some in found.items()}


def _problems(task: Task) -> list[str]:
    """What keeps the drawings from being trained, a sentence each."""
    most, classes = Dimensions(DEFAULT_CHANNELS, 1, 1).max_classes, len(task.labels)
    problems = [] if (large := too_large(task.shapes)) is None else [large]
    if classes > most:
        problems.append(
            f"{classes} classes are more than the default state holds ({most}): train with a wider --state"
        )
    return problems
