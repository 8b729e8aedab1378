"""Grids rebuilt into other drawings while running: tiles that stay go on, new ones are switched on.

The grid of a run has a cell for every tile of both drawings. So neighbours hold the last message of a tile
that was taken away until it has been silent for six periods, and a new tile is absent until its first frame.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import OFFSETS
from tilenca.shapes.batch import Drawings
from tilenca.shapes.cells import removable
from tilenca.shapes.edits import Cell, rows_of
from tilenca.shapes.file import Shape
from tilenca.shapes.stretch import Rows
from tilenca.simulator.conditions import Conditions, Rebuilding
from tilenca.simulator.engine import Engine
from tilenca.simulator.simulator import Simulator, Trajectory

MOST_CHANGES = 2000  # runs of one row; the pairs of thousands of drawings are millions
PLACES_TRIED = 100
CLOCKS = Conditions("clock")
Order = Literal["at once", "adding first", "mixed", "removing first"]
Step = list[tuple[Cell, bool]]  # tiles put down (true) or taken away at the same time


@dataclass(frozen=True)
class Way:
    """How a drawing is rebuilt.

    Attributes:
        order: all tiles "at once", or one after the other: those of the new drawing first ("adding first"),
            the old ones first as far as the rest stays connected ("removing first"), or in any order
            ("mixed"). The tiles are connected all the time.
        between: steps from one tile to the next.
    """

    order: Order = "at once"
    between: int = 1


@dataclass(frozen=True)
class Changed:
    """Rebuilt grids.

    Attributes:
        trajectory: of the new drawings; its first step ends one step after the last change.
        chosen: (R,) the number of each run's new drawing.
        answers: (R,) at the end, see `Simulator.answers`.
    """

    trajectory: Trajectory
    chosen: NDArray[np.int64]
    answers: NDArray[np.int64]


def rebuild(
    engine: Engine,
    drawings: Drawings,
    runs: int,
    before: int,
    after: int,
    random: np.random.Generator,
    way: Way = Way(),
) -> Changed | None:
    """Every drawing rebuilt into every one of another class.

    Args:
        engine: the model.
        drawings: of one size.
        runs: runs of each change.
        before: steps of the old drawing.
        after: steps after the last change.
        random: the only source of chance.
        way: how.

    Returns:
        The runs; None where there is only one class.
    """
    pairs = pairs_of(drawings, runs, random)
    if not pairs:
        return None
    simulator, _ = rebuilt(engine, drawings, pairs, before, random, way)
    trajectory = simulator.run(after)
    return Changed(trajectory, np.array([new for _, new in pairs]), simulator.answers())


def rebuilt(
    engine: Engine,
    drawings: Drawings,
    pairs: Sequence[tuple[int, int]],
    before: int,
    random: np.random.Generator,
    way: Way = Way(),
) -> tuple[Simulator, NDArray[np.bool_]]:
    """Runs in which one drawing is rebuilt into another; the last change comes in the next step.

    Args:
        engine: the model.
        drawings: of both.
        pairs: the numbers of the old and the new drawing of each run.
        before: steps of the old drawing.
        random: the only source of chance.
        way: how.

    Returns:
        The runs, which have a cell for every tile of both drawings, and (N,) whether a cell is one of the new
        drawing, in its own order.
    """
    plan = planned(engine, drawings, pairs, before, random, way)
    plan.simulator.run(plan.last)
    return plan.simulator, plan.new


@dataclass(frozen=True)
class Planned:
    """Runs, not yet begun, in which one drawing is rebuilt into another.

    Attributes:
        simulator: the runs; they have a cell for every tile of both drawings.
        grids: the drawings that these cells make up; `simulator.chosen` numbers them.
        new: (N,) whether a cell is one of the new drawing, in its own order.
        rebuilding: which tiles are there, and which changes come.
        last: steps before the last change; it comes in the next one.
    """

    simulator: Simulator
    grids: Drawings
    new: NDArray[np.bool_]
    rebuilding: Rebuilding
    last: int


def planned(
    engine: Engine,
    drawings: Drawings,
    pairs: Sequence[tuple[int, int]],
    before: int,
    random: np.random.Generator,
    way: Way = Way(),
    conditions: Conditions = CLOCKS,
) -> Planned:
    """The same as `rebuilt`, before its first step; under any conditions."""
    sites = [_Site.plan(drawings, old, new, way.order, random) for old, new in pairs]
    number_of: dict[tuple[Rows, str], int] = {}
    for site in sites:
        number_of.setdefault(site.drawing, len(number_of))
    grids = drawings.of([Shape(label, rows, "") for rows, label in number_of])
    chosen = np.array([number_of[site.drawing] for site in sites])
    last = before + (max(len(site.steps) for site in sites) - 1) * way.between
    rebuilding = _timetable(sites, last, way.between)
    simulator = Simulator(engine, grids, chosen, conditions, random, rebuilding=rebuilding)
    new = np.array([cell in site.new for site in sites for cell in site.cells])
    return Planned(simulator, grids, new, rebuilding, last)


@dataclass(frozen=True)
class _Site:
    """A grid with a cell for every tile of two drawings, and the way from one to the other.

    Attributes:
        cells: all cells, in reading order.
        old: those of the old drawing.
        new: those of the new one.
        steps: the changes.
        label: of the new drawing.
    """

    cells: tuple[Cell, ...]
    old: frozenset[Cell]
    new: frozenset[Cell]
    steps: list[Step]
    label: str

    @property
    def drawing(self) -> tuple[Rows, str]:
        """All cells as a drawing, and its label."""
        return rows_of(self.cells), self.label

    @staticmethod
    def plan(drawings: Drawings, old: int, new: int, order: Order, random: np.random.Generator) -> "_Site":
        """Lays the new drawing on the old one and chooses the order of the changes."""
        tiles = set(drawings.shapes[old].cells)
        wanted = _laid_on(drawings, old, new, random)
        steps = (
            [_all_changes(tiles, wanted)] if order == "at once" else list(walk(tiles, wanted, order, random))
        )
        cells = tuple(sorted(tiles | wanted))
        return _Site(cells, frozenset(tiles), frozenset(wanted), steps, drawings.shapes[new].label)


def _timetable(sites: Sequence[_Site], last: int, between: int) -> Rebuilding:
    """The switches of all runs; each has its last one before step `last`."""
    present: list[bool] = []
    switches: list[tuple[int, int, int]] = []
    for site in sites:
        index = {cell: len(present) + place for place, cell in enumerate(site.cells)}
        present += [cell in site.old for cell in site.cells]
        for back, changes in enumerate(reversed(site.steps)):
            switches += [(last - back * between, index[cell], on) for cell, on in changes]
    return Rebuilding(np.array(present, np.bool_), np.array(sorted(switches), np.int32).reshape(-1, 3))


def pairs_of(drawings: Drawings, runs: int, random: np.random.Generator) -> list[tuple[int, int]]:
    """Every drawing with every one of another class, `runs` times, or `MOST_CHANGES` pairs by chance."""
    classes, every = drawings.classes, range(len(drawings))
    if len(drawings) ** 2 <= MOST_CHANGES:
        pairs = [(old, new) for old in every for new in every if classes[old] != classes[new]] * runs
        some = sorted(random.permutation(len(pairs))[:MOST_CHANGES]) if len(pairs) > MOST_CHANGES else None
        return pairs if some is None else [pairs[number] for number in some]
    drawn = random.integers(len(drawings), size=(2 * MOST_CHANGES, 2))
    return [(int(old), int(new)) for old, new in drawn if classes[old] != classes[new]][:MOST_CHANGES]


def _all_changes(old: set[Cell], new: set[Cell]) -> Step:
    return [(cell, True) for cell in sorted(new - old)] + [(cell, False) for cell in sorted(old - new)]


def walk(old: set[Cell], new: set[Cell], order: Order, random: np.random.Generator) -> Iterator[Step]:
    """The changes from one set of cells to another, one tile at a time; tiles are connected all the time.

    Args:
        old: connected cells.
        new: connected cells, some of them among the old ones.
        order: see `Way`; not "at once".
        random: the only source of chance.
    """
    tiles = set(old)

    def addable() -> list[tuple[Cell, bool]]:
        return [(cell, True) for cell in sorted(new - tiles) if any(near in tiles for near in _around(cell))]

    def takable() -> list[tuple[Cell, bool]]:
        return [(cell, False) for cell in removable(sorted(tiles)) if cell not in new]

    choices: dict[str, Callable[[], list[tuple[Cell, bool]]]] = {
        "adding first": lambda: addable() or takable(),
        "removing first": lambda: takable() or addable(),
        "mixed": lambda: addable() + takable(),
    }
    while possible := choices[order]():
        cell, on = possible[int(random.integers(len(possible)))]
        tiles ^= {cell}
        yield [(cell, on)]


def _laid_on(drawings: Drawings, old: int, new: int, random: np.random.Generator) -> set[Cell]:
    """The new drawing's cells, laid on the old one as `Drawings.overlap` does, but so that they share one."""
    tiles = set(drawings.shapes[old].cells)
    for _ in range(PLACES_TRIED):
        down, right = drawings.place_on(old, new, random)
        wanted = {(row + down, col + right) for row, col in drawings.shapes[new].cells}
        if wanted & tiles:
            return wanted
    # A small drawing may lie in a hole of a large one: then the first tiles lie on each other.
    (row, col), (top, left) = drawings.shapes[old].cells[0], drawings.shapes[new].cells[0]
    return {(r - top + row, c - left + col) for r, c in drawings.shapes[new].cells}


def _around(cell: Cell) -> list[Cell]:
    return [(cell[0] + down, cell[1] + right) for down, right in OFFSETS]
