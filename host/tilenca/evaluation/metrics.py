"""The metrics of a model: targets, the rows of the table of measurements, and the statistics of runs.

A run counts as right when *every* tile shows the right class. `tilenca.evaluation.evaluator` does the runs.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.cases import Case
from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import UNKNOWN
from tilenca.simulator.simulator import Trajectory


@dataclass(frozen=True)
class Target:
    """The target of a row: a share of all runs, and at least `floor` of the runs of every drawing."""

    share: float
    floor: float = 0.0


PERFECT = 0.9995  # 1.000 as it is printed
TARGETS = {
    "drawn": Target(PERFECT, 0.998),
    "converged in 8": Target(0.5),
    "converged in 14": Target(0.95),
    "varied": Target(0.92),
    "trained": Target(0.998, 0.9),
    "held out": Target(0.99),
    "very large": Target(0.99),
    "huge": Target(0.97),
    "lost": Target(0.99),
    "damaged": Target(0.97),
    "damaged, large": Target(0.95),
    "away": Target(PERFECT),
    "the tiles beside the gap say where": Target(0.95),
    "the other tiles say nothing": Target(0.99),
    "no tile says that one is missing": Target(0.95),
    "5 % dead, two tiles thick": Target(0.95),
    "15 % dead, two tiles thick": Target(0.90),
    "one answer": Target(0.99),
    "one tile too many": Target(0.99),
    "random drawings": Target(0.98),
    "halves of drawings": Target(0.90),
    "other choices of the same strokes": Target(0.90),
    "switch": Target(0.999),
    "tile by tile": Target(0.998),
    "larger switch": Target(0.998),
    "long": Target(0.99),
    "longevity": Target(1.0),
}


def target_of(kind: str) -> Target:
    """The target of a kind of rows."""
    return TARGETS[kind]


@dataclass(frozen=True)
class Runs:
    """R runs of the drawings of a case.

    Attributes:
        case: the case.
        chosen: (R,) which of its drawings each run has.
        trajectory: their results.
        answers: by the number of steps, (R,) what all counted tiles of a run showed then, see
            `tilenca.simulator.simulator.Simulator.answers`; steps without an entry were not asked for it.
    """

    case: Case
    chosen: NDArray[np.int64]
    trajectory: Trajectory
    answers: Mapping[int, NDArray[np.int64]] = field(default_factory=dict)


@dataclass(frozen=True)
class Measurement:
    """One line of the table.

    Attributes:
        key: the kind of measurement.
        name: as the table calls it.
        steps: the number of steps (updates per tile) since the start or the last change.
        drawings: how many drawings.
        runs: how many runs of all of them.
        share: of the runs in which every tile was right.
        low, high: 95 % confidence interval of the share (Wilson's), for these drawings.
        worst: the drawing with the smallest share, and that share.
        convergence: steps until all tiles were right and stayed so: median, 95 % (None: never); None for rows
        without such steps.
        target: least share; None: only measured.
        floor: least share of every drawing.
        dash: share of the runs in which all tiles showed the dash, and that was not right; None as `split`.
        wrong: share of the runs in which all tiles showed the same other class; None as `split`.
        split: share of the runs in which tiles of one body showed different answers, the dash included; None
            for rows that are about more than one moment.
        best: the largest share that any tiles could reach, where that is known and less than 1.
    """

    key: str
    name: str
    steps: int
    drawings: int
    runs: int
    share: float
    low: float
    high: float
    worst: tuple[str, float]
    convergence: dict[str, float | None] | None
    target: float | None = None
    floor: float = 0.0
    dash: float | None = None
    wrong: float | None = None
    split: float | None = None
    best: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the target is reached."""
        return self.shortfall == 0

    @property
    def shortfall(self) -> float:
        """The distance below the row's target, 0..1."""
        if self.target is None:
            return 0.0
        return max(0.0, self.target - self.share, self.floor - self.worst[1])

    def text(self) -> str:
        """One line for people."""
        line = f"{self.name}, @{self.steps}: {self.share:.4f}"
        if self.split is not None:
            line += f", dash {self.dash:.4f}, wrong {self.wrong:.4f}, split {self.split:.4f}"
        if self.best is not None:
            line += f", at best {self.best:.4f}"
        if self.holds:
            return line
        worst = (
            f", {self.worst[0]}: {self.worst[1]:.4f}, wanted {self.floor}"
            if self.worst[1] < self.floor
            else ""
        )
        return f"{line} (wanted {self.target}{worst})"

    def as_json(self) -> dict[str, Any]:
        """Plain values for metrics.json."""
        return {
            **asdict(self),
            "worst": {"shape": self.worst[0], "share": self.worst[1]},
            "holds": self.holds,
        }


def wilson(right: int, runs: int) -> tuple[float, float]:
    """95 % confidence interval of a share (Wilson, 1927)."""
    z = 1.959964
    share = right / runs
    middle = (share + z * z / (2 * runs)) / (1 + z * z / runs)
    half = z / (1 + z * z / runs) * math.sqrt(share * (1 - share) / runs + z * z / (4 * runs * runs))
    return max(0.0, middle - half), min(1.0, middle + half)


def convergence_times(converged_at: NDArray[np.float64]) -> dict[str, float | None]:
    """Median and 95th percentile of `Trajectory.converged_at`; None where that many runs never converge."""
    steps = np.sort(converged_at)

    def quantile(share: float) -> float | None:
        value = steps[min(len(steps) - 1, int(np.ceil(share * len(steps))) - 1)]
        return float(value) if np.isfinite(value) else None

    return {"median": quantile(0.5), "p95": quantile(0.95)}


def median_interval(values: NDArray[np.float64]) -> tuple[float, float]:
    """95 % confidence interval of a median, by order statistics; infinite values may be among them."""
    ordered = np.sort(values)
    half = 0.5 * 1.959964 * math.sqrt(len(ordered))
    low = max(0, math.floor(0.5 * len(ordered) - half) - 1)
    high = min(len(ordered) - 1, math.ceil(0.5 * len(ordered) + half))
    return float(ordered[low]), float(ordered[high])


def measure(
    key: str, name: str, runs: Runs, mark: int, target: Target | None, changed_at: int = 0
) -> Measurement:
    """One row of the table.

    Args:
        key: the kind of measurement.
        name: as the table calls it.
        runs: the runs.
        mark: the step after which all tiles must be right.
        target: of the row; None: only measured.
        changed_at: the step of the last change, from which steps are counted.
    """
    agreed = runs.trajectory.agreed[mark - 1]
    dash, wrong, split = (
        answer_shares(runs.case.drawings, runs.chosen, runs.answers[mark])
        if mark in runs.answers
        else (None, None, None)
    )
    shares = {int(n): float(agreed[runs.chosen == n].mean()) for n in np.unique(runs.chosen)}
    worst = min(shares, key=lambda number: shares[number])
    low, high = wilson(int(agreed.sum()), len(agreed))
    return Measurement(
        key,
        name,
        mark - changed_at,
        len(shares),
        len(agreed),
        round(float(agreed.mean()), 5),
        round(low, 5),
        round(high, 5),
        (runs.case.drawings.shapes[worst].name, round(shares[worst], 5)),
        convergence_times(np.maximum(runs.trajectory.converged_at - changed_at, 0)),
        None if target is None else target.share,
        0.0 if target is None else target.floor,
        dash,
        wrong,
        split,
    )


def least_shares(rows: Iterable[Measurement]) -> dict[str, float]:
    """The smallest share by kind of measurement: of the rows with a target, if the kind has any."""
    least: dict[str, tuple[bool, float]] = {}
    for row in rows:
        least[row.key] = min(least.get(row.key, (True, math.inf)), (row.target is None, row.share))
    return {key: share for key, (_, share) in least.items()}


def answer_shares(
    drawings: Drawings, chosen: NDArray[np.int64], answers: NDArray[np.int64]
) -> tuple[float, float, float]:
    """The shares of the runs that are dash, wrong and split, see `Measurement`.

    Args:
        drawings: the task.
        chosen: (R,) the drawing of each run.
        answers: (R,) see `tilenca.simulator.simulator.Simulator.answers`.
    """
    unknown = drawings.labels.index(UNKNOWN) if UNKNOWN in drawings.labels else None
    missed = answers != drawings.classes[chosen]
    dash = missed & (answers == unknown) if unknown is not None else np.zeros_like(missed)
    split = missed & (answers < 0)
    shares = (round(float(kind.mean()), 5) for kind in (dash, missed & ~dash & ~split, split))
    return next(shares), next(shares), next(shares)
