"""Test suites: a task's drawings at every size, damaged, rebuilt, and drawings of no class.

Training never sees the drawings of a case that is `held_out`: certain sizes, and unknown and damaged drawings
whose form is held out (`variant.split_of`), whatever their size. The measurements during training and those
of the final model have no such form in common.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from tilenca.base.errors import UsageError
from tilenca.evaluation.bodies import agreeing_cases, dead_cases
from tilenca.evaluation.cases import LARGE_STEPS, MOST_STEPS, SHORT_STEPS, VERY_LARGE_STEPS, Case, steps_for
from tilenca.evaluation.missing import MissingCase, missing_cases
from tilenca.model.file import Model
from tilenca.shapes import edits
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.shapes.derive import at_size, at_sizes, damaged, draw_unknown, known_of
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.gaps import Gaps
from tilenca.shapes.likeness import index_of
from tilenca.shapes.sizes import Size, Sizes, size_name
from tilenca.shapes.variant import CHOOSING, LAST, TRAINED

VARIANTS = {CHOOSING: 12, LAST: 30}  # of each class
FEWEST = 10  # drawings of no class of which a target is asked
MOST_SETTING = 1e6  # of a recipe, as far as it says what is asked
MOST_DRAWN = 200  # drawings of a file up to which all are measured, and else so many of them
INDEXED = 600  # variants that drawings of no class are compared with
VARIANT_TRIES = 300  # in a row without a new one
# Sizes at which a tile is missing, beside the files' own, where the task has them.
DAMAGED_SIZES: tuple[Size, ...] = ((6, 4), (7, 7), (8, 6), (12, 10))
DAMAGED_LARGE = 100  # such a drawing has another target from this area on


@dataclass(frozen=True)
class Suite:
    """All sets of a task.

    Attributes:
        drawn: the drawings of the files, one case for each.
        sizes: the first file's drawings at other sizes, the trained ones together, each held out one alone
            and without drawings that are also those of a trained size (a line has no width).
        damaged: one tile missing where that leaves no doubt about the class: for several sizes the pairs of a
            drawing and a missing tile that training may use, and those that are held out from it.
        unknown: drawings of no class; empty where the model has no class for them.
        larger: the first file's drawings at a larger trained size, and at the largest.
        varied: variants of held-out forms; None: the classes are just their drawings.
        dead: the drawings at a larger size, with shares of dead tiles.
        agreeing: any connected drawings, whose tiles must agree on one answer.
        missing: drawings whose tiles are asked where one is missing; empty where the model does not say it.
        slow_changes: whether to change drawings tile by tile, too, which takes long where they are large.
    """

    drawn: tuple[Case, ...]
    sizes: tuple[Case, ...]
    damaged: tuple[Case, ...]
    unknown: tuple[Case, ...]
    larger: tuple[Case, ...]
    varied: Case | None = None
    dead: tuple[Case, ...] = ()
    agreeing: tuple[Case, ...] = ()
    missing: tuple[MissingCase, ...] = ()
    slow_changes: bool = True


@dataclass(frozen=True)
class Aims:
    """The aims of a training, beside the drawings of the files.

    Attributes:
        stretch: largest factor of the drawn size.
        damaged: whether tiles may be missing.
        unknown: whether tiles show a dash on drawings of no class.
        varied: whether classes are what their drawings may become. Then a drawing of no class must not be
            like one of them; else it only must not be one of them.
        directions: whether tiles say where one is missing.
        agreeing: whether tiles give one answer on drawings of no class, whatever it is.
    """

    stretch: float = 1.0
    damaged: bool = False
    unknown: bool = False
    varied: bool = False
    directions: bool = False
    agreeing: bool = False


def recorded_aims(model: Model) -> Aims:
    """The aims in the model's metadata; its drawings alone where the metadata have none.

    Raises:
        UsageError: the metadata are damaged.
    """
    recipe = model.metadata.get("recipe", {})
    names = ("stretch", "damaged", "unknown", "varied", "unlabelled")
    values = [recipe.get(name, 1.0 if name == "stretch" else 0.0) for name in names]
    if not all(isinstance(value, int | float) and 0 <= value <= MOST_SETTING for value in values):
        raise UsageError(f"model {model.model_id:04X}: metadata.recipe has no numbers in it; train it again")
    stretch, *shares = map(float, values)
    return aims_with(stretch, *shares, directions=model.dimensions.directions)


def aims_with(
    stretch: float, damaged: float, unknown: float, varied: float, unlabelled: float, *, directions: float
) -> Aims:
    """The aims of a training with these settings of its recipe (`tilenca.training.recipe.Recipe`)."""
    agreeing = unknown > 0 or unlabelled > 0
    return Aims(stretch, damaged > 0, unknown > 0, varied > 0, directions > 0, agreeing)


def make_suite(
    task: Drawings, sizes: Sizes, labels: tuple[str, ...], aims: Aims, seed: int, split: str = LAST
) -> Suite:
    """Makes the suite of a task; of files with thousands of drawings it asks some, by the seed.

    Args:
        task: the drawings of its files.
        sizes: of the task.
        labels: the model's.
        aims: of its training.
        seed: of the unknown drawings, of the variants, and of those that are asked of very many.
        split: which held-out forms to ask: those for `CHOOSING` a model, or those for the `LAST` measurement.
    """
    task, shortened = _shortened(replace(task, labels=labels), seed)
    first = task.group(0)
    drawn = tuple(
        Case("drawn", source["file"] + shortened.get(number, ""), task.of(task.group(number)), SHORT_STEPS)
        for number, source in enumerate(task.sources)
    )
    aimed = sizes.within(task.largest, aims.stretch)
    return Suite(
        drawn,
        tuple(_size_cases(task, first, sizes, aimed)),
        tuple(_damaged_cases(task, first, aimed, aims, split)),
        tuple(unknown_cases(task, first, aims, seed, split)) if UNKNOWN in labels else (),
        tuple(_larger(task, first, aimed)),
        varied_case(task, aims, seed, split),
        () if shortened else tuple(dead_cases(task, first, aimed, aims.damaged, aims.varied)),
        tuple(agreeing_cases(task, first, aimed, seed, aims.agreeing)),
        tuple(_missing_cases(task, first, aimed, split)) if aims.directions else (),
        slow_changes=not shortened,
    )


def _shortened(task: Drawings, seed: int) -> tuple[Drawings, dict[int, str]]:
    """The task with some drawings of each file that has very many, and what to call those files."""
    random = np.random.default_rng(seed)
    kept: list[int] = []
    shortened = {}
    for number in range(len(task.sources)):
        mine = np.flatnonzero(np.array(task.groups) == number)
        if len(mine) > MOST_DRAWN:
            mine = np.sort(random.permutation(mine)[:MOST_DRAWN])
            shortened[number] = f", {MOST_DRAWN} of its drawings"
        kept += mine.tolist()
    if not shortened:
        return task, {}
    shapes = tuple(task.shapes[number] for number in kept)
    groups = tuple(task.groups[number] for number in kept)
    return replace(task, shapes=shapes, groups=groups), shortened


def varied_case(task: Drawings, aims: Aims, seed: int, split: str) -> Case | None:
    """Variants of forms that training never draws; None where the classes are just their drawings."""
    if task.variants is None:
        return None
    random = np.random.default_rng(seed)
    found: dict[tuple[str, ...], Shape] = {}
    for label in task.variants.labels:
        wanted, idle = len(found) + VARIANTS[split], 0
        while len(found) < wanted and idle < VARIANT_TRIES:
            variant = task.variants.draw(label, split, random)
            idle += 1
            if variant is not None and variant.rows not in found:
                found[variant.rows] = Shape(label, variant.rows, f"{label}, {'/'.join(variant.rows)}")
                idle = 0
    name = f"held-out forms, {size_name(task.variants.least)} to {size_name(task.variants.most)}"
    if not found:
        return None
    drawings = task.of(list(found.values()))
    return Case("varied", name, drawings, LARGE_STEPS, held_out=True, aimed=aims.varied)


def _size_cases(task: Drawings, first: Sequence[Shape], sizes: Sizes, aimed: Sizes) -> Iterable[Case]:
    trained = _distinct(shape for size in aimed.trained for shape in at_size(first, size))
    trained = [shape for shape in trained if shape.rows not in [drawn.rows for drawn in first]]
    if trained:
        yield Case("trained", "all sizes trained on", task.of(trained), max(map(steps_for, aimed.trained)))
    new = [*sizes.held_out] if trained else [*_larger_sizes(task, sizes)[:1], *sizes.held_out]
    most = max((*aimed.trained, *aimed.more), default=(0, 0), key=lambda size: size[0] * size[1])
    reach = 2 if aimed.more else 1.5
    for path in (*sizes.drawn, *sizes.measured):
        drawings = load_drawings([path], labels=task.labels)
        steps = SHORT_STEPS if path in sizes.drawn else steps_for(drawings.largest)
        yield Case("held out", f"{path.name}, never trained on", drawings, steps, held_out=True, aimed=False)
    trainable = chain(task.shapes, *at_sizes(first, (*aimed.trained, *aimed.more)))
    seen = {shape.rows for shape in trainable}
    for size in new:
        if shapes := [shape for shape in _distinct(at_size(first, size)) if shape.rows not in seen]:
            # The aim is sizes up to half as large again as the trained ones, or twice where these are large.
            steps = steps_for(size)
            kinds = {LARGE_STEPS: "held out", VERY_LARGE_STEPS: "very large", MOST_STEPS: "huge"}
            yield Case(
                next(kind for most, kind in kinds.items() if steps <= most),
                f"{size_name(size)}, never trained on",
                task.of(shapes),
                steps,
                held_out=True,
                aimed=size[0] <= reach * most[0] and size[1] <= reach * most[1],
            )


def _larger_sizes(task: Drawings, sizes: Sizes) -> list[Size]:
    """The trained sizes with about half as many rows and columns again, or more."""
    height, width = task.largest
    return [size for size in sizes.trained if size[0] >= 1.4 * height and size[1] >= 1.4 * width]


def _larger(task: Drawings, first: Sequence[Shape], sizes: Sizes) -> Iterable[Case]:
    """A larger size, and the largest."""
    wanted = _larger_sizes(task, sizes)
    for size in dict.fromkeys((wanted[0], wanted[-1]) if wanted else ()):
        kind = "drawn" if steps_for(size) <= SHORT_STEPS else "trained"
        yield Case(kind, size_name(size), task.of(at_size(first, size)), steps_for(size))


def _damaged_sizes(task: Drawings, aimed: Sizes) -> tuple[Size | None, ...]:
    return None, *(size for size in DAMAGED_SIZES if size in aimed.trained and size != task.largest)


def _missing_cases(task: Drawings, first: Sequence[Shape], aimed: Sizes, split: str) -> Iterable[MissingCase]:
    """What tiles say is missing, at the sizes of `_damaged_cases`."""
    gaps = Gaps(chain(task.shapes, *at_sizes(first, (*aimed.trained, *aimed.more))))
    return missing_cases(task, first, gaps, _damaged_sizes(task, aimed), split)


def _damaged_cases(
    task: Drawings, first: Sequence[Shape], aimed: Sizes, aims: Aims, split: str
) -> Iterable[Case]:
    """One tile missing, at the drawn size and at others: pairs that training may use, and new ones."""
    for size in _damaged_sizes(task, aimed):
        shapes = first if size is None else at_size(first, size)
        steps = SHORT_STEPS if size is None else steps_for(size)
        known = known_of([*task.shapes, *shapes])
        height, width = size or task.largest
        kind = "damaged" if height * width < DAMAGED_LARGE else "damaged, large"
        for which, name in ((TRAINED, "pairs that training may use"), (split, "new pairs")):
            if less := damaged(shapes, known, " less one", which):
                label = f"{size_name(size or task.largest)}, one tile missing, {name}"
                new = which == split
                yield Case(kind, label, task.of(less), steps, held_out=new, aimed=aims.damaged)


def unknown_cases(
    task: Drawings, first: Sequence[Shape], aims: Aims, seed: int, split: str
) -> Iterable[Case]:
    """Drawings of no class: neither known nor, where classes vary, so much like one that they could be it."""
    random = np.random.default_rng(seed)
    known = known_of(task.shapes)
    drawings = [shape.rows for shape in first]
    likeness = None
    if task.variants is not None and aims.varied:
        likeness, _ = index_of([shape.rows for shape in task.shapes], task.variants, INDEXED, random)
    for name, wanted, draw, of_strokes in (
        ("random drawings", 500, edits.some_grown(drawings, random, least=4), False),
        ("halves of drawings", 100, edits.some_halves(drawings, random), True),
        ("other choices of the same strokes", 100, edits.some_strokes(drawings, random), True),
    ):
        found = draw_unknown(wanted, draw, known, split)
        shapes = [
            Shape(UNKNOWN, rows, f"none, {'/'.join(rows)}")
            for rows in found
            if likeness is None or not likeness.could_be_one(rows, of_strokes)
        ]
        if shapes:
            label = f"no class: {name}, forms never trained on"
            yield Case(
                name,
                label,
                task.of(shapes),
                SHORT_STEPS,
                held_out=True,
                aimed=aims.unknown and len(shapes) >= FEWEST,
            )


def _distinct(shapes: Iterable[Shape]) -> list[Shape]:
    return list({shape.rows: shape for shape in shapes}.values())
