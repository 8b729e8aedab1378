"""Grids rebuilt into other drawings while running: tiles that stay keep their state, new ones are seeds."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import OFFSETS
from tilenca.shapes.batch import Drawings
from tilenca.shapes.cells import removable
from tilenca.shapes.file import Shape
from tilenca.shapes.variants import Cell, rows_of
from tilenca.simulator.engine import Engine, States
from tilenca.simulator.simulator import Conditions, Simulator, Trajectory

BETWEEN = 3  # steps from one tile to the next
PLACES_TRIED = 100
Changed = tuple[Trajectory, NDArray[np.int64]]


def rebuild(
    engine: Engine, drawings: Drawings, runs: int, before: int, after: int, random: np.random.Generator
) -> Changed | None:
    """Every drawing rebuilt at once into every one of another class.

    Args:
        engine: the model.
        drawings: of one size.
        runs: runs of each change.
        before: steps of the old drawing.
        after: steps of the new one.
        random: the only source of chance.

    Returns:
        The trajectory of the new drawings, and (R,) their numbers; None where there is only one class.
    """
    pairs = np.array(list(_pairs(drawings)) * runs, dtype=np.int64).reshape(-1, 2)
    if not len(pairs):
        return None
    old, new = pairs.T
    first = Simulator(engine, drawings, old, Conditions("clock"), random)
    first.run(before)
    stays = [drawings.overlap(int(a), int(b), random) for a, b in pairs]
    states = moved(engine, first, stays)
    return Simulator(engine, drawings, new, Conditions("clock", boot=0.0), random, states).run(after), new


def rebuild_tile_by_tile(
    engine: Engine, drawings: Drawings, runs: int, before: int, after: int, random: np.random.Generator
) -> Changed | None:
    """The same, one tile after the other: those of the new drawing put down, then the old ones taken away.

    States are kept. All tiles' clocks are drawn anew at every change, and the last messages are forgotten;
    real tiles have it easier.
    """
    pairs = list(_pairs(drawings)) * runs
    if not pairs:
        return None
    walks = [list(_walk(drawings, old, new, random)) for old, new in pairs]
    lengths = np.array([len(walk) for walk in walks])
    numbers: dict[tuple[Cell, ...], int] = {}
    for walk in walks:
        for cells in walk:
            numbers.setdefault(cells, len(numbers))
    every = drawings.of([Shape(drawings.labels[0], rows_of(cells), "") for cells in numbers])
    state = None
    for step in range(int(lengths.max())):
        # Runs that have reached their new drawing wait for the others.
        now = [walk[min(step, len(walk) - 1)] for walk in walks]
        chosen = np.array([numbers[cells] for cells in now])
        boot = 10.0 if state is None else 0.0
        simulator = Simulator(engine, every, chosen, Conditions("clock", boot=boot), random, state)
        simulator.run(before if step == 0 else BETWEEN)
        following = [walk[min(step + 1, len(walk) - 1)] for walk in walks]
        state = moved(engine, simulator, [_stays(a, b) for a, b in zip(now, following, strict=True)])
    new = np.array([pair[1] for pair in pairs])
    return Simulator(engine, drawings, new, Conditions("clock", boot=0.0), random, state).run(after), new


def _pairs(drawings: Drawings) -> Iterator[tuple[int, int]]:
    classes = drawings.classes
    for old in range(len(drawings)):
        for new in range(len(drawings)):
            if classes[old] != classes[new]:
                yield old, new


def moved(engine: Engine, before: Simulator, stays: Sequence[NDArray[np.int64]]) -> States:
    """States of the tiles of every run's new drawing, from where `stays` says, or the seed's (-1)."""
    parts = []
    for start, places in zip(before.batch.starts, stays, strict=True):
        states = engine.seed(len(places))
        kept = places >= 0
        states[kept] = before.states[start + places[kept]]
        parts.append(states)
    return np.concatenate(parts)


def _walk(drawings: Drawings, old: int, new: int, random: np.random.Generator) -> Iterator[tuple[Cell, ...]]:
    """Connected sets of cells from one drawing to another, one tile apart, each sorted."""
    tiles = set(drawings.shapes[old].cells)
    wanted = _laid_on(drawings, old, new, random)
    yield tuple(sorted(tiles))
    while missing := sorted(cell for cell in wanted - tiles if any(near in tiles for near in _around(cell))):
        tiles.add(missing[int(random.integers(len(missing)))])
        yield tuple(sorted(tiles))
    while extra := [cell for cell in removable(sorted(tiles)) if cell not in wanted]:
        tiles.remove(extra[int(random.integers(len(extra)))])
        yield tuple(sorted(tiles))


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


def _stays(now: Sequence[Cell], following: Sequence[Cell]) -> NDArray[np.int64]:
    places = {cell: place for place, cell in enumerate(now)}
    return np.array([places.get(cell, -1) for cell in following], dtype=np.int64)
