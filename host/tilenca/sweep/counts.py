"""What runs came to, in numbers that add up in any order of the blocks."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.metrics import convergence_times


@dataclass(frozen=True)
class Counts:
    """The results of some runs.

    Attributes:
        runs: how many.
        right: of them, those in which every counted tile was right at the end.
        dash, wrong, split: those in which all showed the dash, all another class, or tiles differed.
        cells: the share of counted tiles that were right at the end, summed over the runs.
        converged: runs by the step from which they were right to the end; those that never were are in none.
        updates: cell updates computed.
    """

    runs: int
    right: int
    dash: int
    wrong: int
    split: int
    cells: float
    converged: dict[int, int] = field(default_factory=dict)
    updates: int = 0

    @staticmethod
    def of(
        right: NDArray[np.floating[Any]],
        converged_at: NDArray[np.float64],
        answers: NDArray[np.int64],
        target: int,
        unknown: int | None,
        updates: int,
    ) -> "Counts":
        """Counts runs of one class.

        Args:
            right: (R,) share of counted tiles that were right at the end.
            converged_at: (R,) see `Trajectory.converged_at`.
            answers: (R,) see `Simulator.answers`.
            target: the class that is right.
            unknown: the class of the dash; None: the model has none.
            updates: cell updates computed.
        """
        missed = answers != target
        dash = missed & (answers == (unknown if unknown is not None else target))
        split = missed & (answers < 0)
        steps = Counter(int(step) for step in converged_at if math.isfinite(step))
        return Counts(
            len(right),
            int((right >= 1).sum()),
            int(dash.sum()),
            int((missed & ~dash & ~split).sum()),
            int(split.sum()),
            math.fsum(right),
            dict(sorted(steps.items())),
            updates,
        )

    @staticmethod
    def total(parts: Iterable["Counts"]) -> "Counts":
        """All parts together."""
        every: Sequence[Counts] = list(parts)
        converged: Counter[int] = Counter()
        for part in every:
            converged.update(part.converged)
        names = ("runs", "right", "dash", "wrong", "split", "updates")
        return Counts(
            **{name: sum(getattr(part, name) for part in every) for name in names},
            cells=math.fsum(part.cells for part in every),  # the exact sum, rounded once: no order matters
            converged=dict(sorted(converged.items())),
        )

    def times(self) -> dict[str, float | None]:
        """Median and 95th percentile of the steps to agreement; None where that many runs never agree."""
        steps = [*self.converged, math.inf]
        runs = [*self.converged.values(), self.runs - sum(self.converged.values())]
        return convergence_times(np.repeat(np.array(steps, np.float64), runs))

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)

    @staticmethod
    def from_json(values: dict[str, Any]) -> "Counts":
        """The counts of `as_json`."""
        converged = {int(step): int(runs) for step, runs in values["converged"].items()}
        return Counts(**{**values, "converged": converged})
