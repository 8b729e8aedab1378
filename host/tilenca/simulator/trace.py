"""A recorded run of the fast simulator: the class that every tile of a drawing shows, step by step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model
from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import Shape
from tilenca.simulator.conditions import Conditions, ScheduleKind
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator

NOTHING = -1


@dataclass(frozen=True)
class Film:
    """One run.

    Attributes:
        shape: the drawing.
        labels: the model's classes.
        shown: (T + 1, N) int64, the class that each tile of `shape.cells` shows at the start and after each
            step, NOTHING before its first update.
        about: a caption.
    """

    shape: Shape
    labels: tuple[str, ...]
    shown: NDArray[np.int64]
    about: str

    @property
    def right(self) -> NDArray[np.bool_]:
        """(T + 1,) whether every tile shows the drawing's label."""
        right: NDArray[np.bool_] = (self.shown == self.labels.index(self.shape.label)).all(axis=1)
        return right

    @property
    def agreed_at(self) -> int | None:
        """The step from which every tile is right to the end; None: there is none."""
        wrong = np.flatnonzero(~self.right)
        converged_at = 0 if len(wrong) == 0 else int(wrong[-1]) + 1
        return converged_at if converged_at < len(self.shown) else None


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
        Conditions(schedule, boot=1.0),
        np.random.default_rng(seed),
    )

    pictures = [np.full((1, simulator.cells), NOTHING, np.int8)]
    if (shown := simulator.run(steps, record=True).shown) is not None:
        pictures.append(shown)
    updates = "every tile on its own clock" if schedule == "clock" else "random updates, as in the paper"
    about = f"model {model.model_id:04X}, {updates}, seed {seed}; a step is one update per tile"
    return Film(drawings.shapes[number], model.labels, np.concatenate(pictures).astype(np.int64), about)
