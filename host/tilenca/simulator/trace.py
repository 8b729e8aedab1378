"""A recorded run of the fast simulator: the class that every tile of a drawing shows, step by step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model
from tilenca.shapes.batch import Drawings
from tilenca.shapes.edits import Cell
from tilenca.simulator.conditions import Conditions, Rebuilding, ScheduleKind
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.simulator.transitions import Way, planned

NOTHING = -1
STARTED_WITHIN = 1.0  # updates


@dataclass(frozen=True)
class Film:
    """One run.

    Attributes:
        name: of what the tiles form, such as “4”.
        cells: N, the places of the tiles, by row and column.
        labels: the model's classes.
        shown: (T + 1, N) int64, the class that each tile shows at the start and after each step, NOTHING
            before its first update.
        there: (T + 1, N) bool, whether a tile lies in that place then.
        wanted: (T + 1,) int64, the class that they should show; NOTHING while they are being rebuilt.
        about: a caption.
    """

    name: str
    cells: tuple[Cell, ...]
    labels: tuple[str, ...]
    shown: NDArray[np.int64]
    there: NDArray[np.bool_]
    wanted: NDArray[np.int64]
    about: str

    @property
    def right(self) -> NDArray[np.bool_]:
        """(T + 1,) whether every tile that is there shows what it should."""
        as_wanted = (self.shown == self.wanted[:, None]) | ~self.there
        right: NDArray[np.bool_] = as_wanted.all(axis=1) & (self.wanted != NOTHING)
        return right

    @property
    def agreed_at(self) -> int | None:
        """The step from which every tile is right to the end; None: there is none."""
        wrong = np.flatnonzero(~self.right)
        converged_at = 0 if len(wrong) == 0 else int(wrong[-1]) + 1
        return converged_at if converged_at < len(self.shown) else None

    @property
    def eventful(self) -> NDArray[np.int64]:
        """(E,) the steps at whose end anything is not as after the one before; 0 is one of them."""
        unlike = (self.shown[1:] != self.shown[:-1]) | (self.there[1:] != self.there[:-1])
        return np.flatnonzero(np.concatenate(([True], unlike.any(axis=1))))


def record(
    model: Model, drawings: Drawings, number: int, steps: int, schedule: ScheduleKind, seed: int
) -> Film:
    """Records a run of one drawing; its tiles are switched on within one update of each other.

    Args:
        model: of the tiles.
        drawings: the task.
        number: which of the drawings.
        steps: updates per tile.
        schedule: see `tilenca.simulator.simulator.Conditions`.
        seed: the same seed gives the same film.

    Raises:
        BuildError: the simulator is not built.
    """
    simulator = Simulator(
        FastEngine(model),
        drawings,
        np.array([number], np.int64),
        Conditions(schedule, boot=STARTED_WITHIN),
        np.random.default_rng(seed),
    )
    shape = drawings.shapes[number]
    updates = "every tile on its own clock" if schedule == "clock" else "random updates, as in the paper"
    return Film(
        _quoted(shape.label),
        tuple(shape.cells),
        model.labels,
        _shown(simulator, steps),
        np.ones((steps + 1, simulator.cells), np.bool_),
        np.full(steps + 1, model.labels.index(shape.label)),
        f"model {model.model_id:04X}, {updates}, seed {seed}; a step is one update per tile",
    )


def record_change(
    model: Model, drawings: Drawings, numbers: tuple[int, int], steps: int, between: int, seed: int
) -> Film:
    """Records tiles on their own clocks that form one drawing, and are rebuilt into another one.

    Args:
        model: of the tiles.
        drawings: the task.
        numbers: of the old and of the new drawing.
        steps: updates per tile before the first change, and after the last one.
        between: updates from one tile that comes or goes to the next; 0: all at once.
        seed: the same seed gives the same film.

    Raises:
        BuildError: the simulator is not built.
    """
    way = Way("mixed", between) if between else Way()
    started = Conditions("clock", boot=STARTED_WITHIN)
    plan = planned(FastEngine(model), drawings, [numbers], steps, np.random.default_rng(seed), way, started)
    old, new = (drawings.shapes[number].label for number in numbers)
    wanted = np.full(plan.last + steps + 1, NOTHING)
    wanted[: steps + 1] = model.labels.index(old)
    wanted[plan.last + 1 :] = model.labels.index(new)
    how = f"a tile every {between} steps from step {steps} on" if between else f"rebuilt after step {steps}"
    return Film(
        f"{_quoted(old)} to {_quoted(new)}",
        tuple(plan.grids.shapes[0].cells),
        model.labels,
        _shown(plan.simulator, plan.last + steps),
        _there(plan.rebuilding, plan.last + steps),
        wanted,
        f"model {model.model_id:04X}, {how}, seed {seed}; a step is one update per tile",
    )


def _quoted(label: str) -> str:
    return f"\N{LEFT DOUBLE QUOTATION MARK}{label}\N{RIGHT DOUBLE QUOTATION MARK}"


def _shown(simulator: Simulator, steps: int) -> NDArray[np.int64]:
    """(T + 1, N) the class that each tile shows, nothing at the start."""
    pictures = [np.full((1, simulator.cells), NOTHING, np.int8)]
    if (shown := simulator.run(steps, record=True).shown) is not None:
        pictures.append(shown)
    return np.concatenate(pictures).astype(np.int64)


def _there(rebuilding: Rebuilding, steps: int) -> NDArray[np.bool_]:
    """(T + 1, N) whether a tile is there; a change before step `s` shows from the end of that step on."""
    there = np.tile(rebuilding.present, (steps + 1, 1))
    for step, cell, on in rebuilding.switches:
        there[step + 1 :, cell] = on
    return there
