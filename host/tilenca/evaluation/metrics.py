"""Measures a trained model: one table of measurements, the same for every recipe.

Everything runs on the firmware's own core. A run counts as right when *every* tile shows the right class.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.suites import Case, Suite
from tilenca.simulator.engine import Engine
from tilenca.simulator.simulator import Conditions, Fault, ScheduleKind, Simulator, Trajectory
from tilenca.simulator.transitions import rebuild, rebuild_tile_by_tile

MARKS = (10, 30, 60)  # steps after which agreement is reported
CONVERGENCE_STEPS = (8, 14)  # steps within which half, and nearly all, of the runs are to converge
CONVERGED_BY = MARKS[-1]  # from here on a wrong tile counts as a regression
LONG = 1000
LEAST_LASTING = 3000  # steps without a regression, in short measurements; slow drifts show after two thousand
SCHEDULES: dict[ScheduleKind, str] = {"random": "the paper's sampler", "clock": "the tiles' own clocks"}
CLOCK = Conditions("clock")
FaultKind = Literal["dead", "stuck", "away"]
Say = Callable[[str], None]


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
    "trained": Target(0.998, 0.9),
    "held out": Target(0.99),
    "very large": Target(0.95),
    "lost": Target(0.99),
    "damaged": Target(0.97),
    "away": Target(PERFECT),
    "random drawings": Target(0.98),
    "halves of drawings": Target(0.90),
    "other choices of the same strokes": Target(0.90),
    "switch": Target(0.999),
    "tile by tile": Target(0.998),
    "larger switch": Target(0.998),
    "long": Target(0.99),
    "longevity": Target(1.0),
}


@dataclass(frozen=True)
class Measurement:
    """One line of the table.

    Attributes:
        key: the kind of measurement.
        name: as the table calls it.
        steps: after how many steps (updates per tile) since the start or the last change.
        drawings: how many drawings.
        runs: how many runs of all of them.
        share: of the runs in which every tile was right.
        low, high: 95 % confidence interval of the share (Wilson's), for these drawings.
        worst: the drawing with the smallest share, and that share.
        convergence: steps until all tiles were right and stayed so: median, 95 % (None: never); None where
            that makes no sense.
        target: least share; None: only measured.
        floor: least share of every drawing.
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

    @property
    def holds(self) -> bool:
        """Whether the target is reached."""
        return self.shortfall == 0

    @property
    def shortfall(self) -> float:
        """How far below its target the row is, 0..1."""
        if self.target is None:
            return 0.0
        return max(0.0, self.target - self.share, self.floor - self.worst[1])

    def text(self) -> str:
        """One line for people."""
        line = f"{self.name}, @{self.steps}: {self.share:.4f}"
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


class Evaluator:
    """Measures one model.

    Args:
        engine: the model's.
        suite: the cases to measure.
        runs: runs of each drawing; longevity takes a fifth of them over 20 steps for each.
        seed: of the random generator.
    """

    def __init__(self, engine: Engine, suite: Suite, runs: int, seed: int) -> None:
        self.engine, self.suite, self.runs = engine, suite, runs
        self.random = np.random.default_rng(seed)

    def short_rows(self) -> Iterator[Measurement]:
        """The measurements during training: the clocks only, and nothing that takes long."""
        yield from self.agreement({"clock": SCHEDULES["clock"]})
        for part in (self.sizes, self.disturbed, self.unknown):
            yield from part()
        yield from self.changes(one_by_one=False)
        yield from self.longevity()

    def rows(self) -> Iterator[Measurement]:
        """All measurements, in the order of the table."""
        yield from self.agreement()
        yield from self.sizes()
        yield from self.disturbed()
        yield from self.unknown()
        yield from self.changes()
        yield from self.longevity()

    def agreement(self, schedules: Mapping[ScheduleKind, str] = SCHEDULES) -> Iterator[Measurement]:
        """The files' drawings on both schedules, the first file's time to converge, and larger drawings."""
        for case in self.suite.drawn:
            for schedule, name in schedules.items():
                trajectory, chosen = self._run(case, Conditions(schedule), CONVERGED_BY)
                for mark in MARKS:
                    target = TARGETS[case.kind] if mark > MARKS[0] else None
                    yield self._row(
                        "drawings", f"{case.name}, {name}", case, chosen, trajectory, mark, target
                    )
                if case is self.suite.drawn[0] and schedule == "clock":
                    for steps in CONVERGENCE_STEPS:
                        soon = Trajectory((trajectory.converged_at <= steps).astype(np.float32)[None])
                        target = TARGETS[f"converged in {steps}"]
                        row = self._row(
                            "convergence", f"{case.name}, converged", case, chosen, soon, 1, target
                        )
                        yield replace(row, steps=steps, convergence=None)
        for case in self.suite.larger:
            trajectory, chosen = self._run(case, CLOCK, case.steps)
            yield self._row("sizes", case.name, case, chosen, trajectory, case.steps, TARGETS[case.kind])

    def sizes(self) -> Iterator[Measurement]:
        """Other sizes."""
        for case in self.suite.sizes:
            runs = self.runs if case.held_out else max(2, self.runs // 25)
            trajectory, chosen = self._run(case, CLOCK, case.steps, runs)
            target = TARGETS[case.kind] if case.aimed else None
            yield self._row("sizes", case.name, case, chosen, trajectory, case.steps, target)

    def disturbed(self) -> Iterator[Measurement]:
        """Lost messages, and tiles that are missing, dead, stuck, or away for a while."""
        drawn, lost = self.suite.drawn[0], TARGETS["lost"]
        for name, conditions in (
            ("20 % of the messages lost, read as zero", Conditions("clock", loss=0.2, lost="zero")),
            ("50 % of the messages lost, last one held", Conditions("clock", loss=0.5, lost="held")),
        ):
            trajectory, chosen = self._run(drawn, conditions, CONVERGED_BY)
            yield self._row("lost", name, drawn, chosen, trajectory, CONVERGED_BY, lost)
        if (damaged := self.suite.damaged) is not None:
            name = "one tile missing, where that leaves no doubt about the class"
            trajectory, chosen = self._run(damaged, CLOCK, CONVERGED_BY, max(2, self.runs // 5))
            target = TARGETS["damaged"] if damaged.aimed else None
            yield self._row("damaged", name, damaged, chosen, trajectory, CONVERGED_BY, target)
        large = [n for n, size in enumerate(drawn.drawings.sizes) if size > 1]
        if not large:
            return  # without a single tile no tile is left to measure
        several = replace(drawn, drawings=drawn.drawings.chosen(large))
        faults: tuple[tuple[str, FaultKind, int, int | None, Target | None], ...] = (
            ("any one tile dead, the others asked", "dead", 0, None, None),
            ("any one tile stuck after 5 steps, the others asked", "stuck", 5, None, None),
            ("any one tile off from step 30 to 60, back again", "away", 30, CONVERGED_BY, TARGETS["away"]),
        )
        for name, kind, begin, end, target in faults:
            since = end or begin
            trajectory, chosen = self._run(several, CLOCK, since + CONVERGED_BY, fault=(kind, begin, end))
            yield self._row("faults", name, several, chosen, trajectory, since + CONVERGED_BY, target, since)

    def unknown(self) -> Iterator[Measurement]:
        """Drawings of no class: a run is right if every tile shows the dash."""
        for case in self.suite.unknown:
            each = max(2, 10 * self.runs // len(case.drawings))
            trajectory, chosen = self._run(case, CLOCK, case.steps, each)
            target = TARGETS[case.kind] if case.aimed else None
            yield self._row("unknown", case.name, case, chosen, trajectory, case.steps, target)

    def changes(self, one_by_one: bool = True) -> Iterator[Measurement]:
        """Every change from one class to another on running tiles, without a reset."""
        drawn = self.suite.drawn[0]
        for case, how, change, target in (
            (drawn, "at once", rebuild, "switch"),
            *(((drawn, "tile by tile", rebuild_tile_by_tile, "tile by tile"),) if one_by_one else ()),
            *((case, "at once", rebuild, "larger switch") for case in self.suite.larger),
        ):
            runs = max(1, self.runs // (10 if how == "at once" else 50))
            changed = change(self.engine, case.drawings, runs, CONVERGED_BY, case.steps, self.random)
            if changed is not None:
                trajectory, chosen = changed
                name = f"{case.name}, changes to every other class {how}"
                yield self._row("changes", name, case, chosen, trajectory, case.steps, TARGETS[target])

    def longevity(self) -> Iterator[Measurement]:
        """Long runs: all right after 1000 steps, and without a regression after convergence."""
        drawn = self.suite.drawn[0]
        trajectory, chosen = self._run(drawn, CLOCK, LONG, max(1, self.runs // 5))
        name = f"{drawn.name}, {SCHEDULES['clock']}"
        yield self._row("longevity", name, drawn, chosen, trajectory, LONG, TARGETS["long"])
        steps = max(LEAST_LASTING, 20 * self.runs)
        for case in (self.suite.drawn[0], *self.suite.larger[-1:]):
            each = max(1, -(-self.runs // (5 * len(case.drawings))))
            trajectory, chosen = self._run(case, CLOCK, case.steps + steps, each)
            always = Trajectory(trajectory.right[case.steps - 1 :].min(axis=0, keepdims=True))
            name = f"{case.name}, no regression in {steps} more steps"
            row = self._row("longevity", name, case, chosen, always, 1, TARGETS["longevity"])
            yield replace(row, steps=case.steps + steps, convergence=None)

    def _run(
        self,
        case: Case,
        conditions: Conditions,
        steps: int,
        runs: int | None = None,
        fault: tuple[FaultKind, int, int | None] | None = None,
    ) -> tuple[Trajectory, NDArray[np.int64]]:
        chosen = np.repeat(np.arange(len(case.drawings)), self.runs if runs is None else runs)
        faults = None
        if fault is not None:
            kind, begin, end = fault
            faults = Fault(kind, self.random.integers(case.drawings.sizes[chosen]), begin, end)
        simulator = Simulator(self.engine, case.drawings, chosen, conditions, self.random, fault=faults)
        return simulator.run(steps), chosen

    def _row(
        self,
        key: str,
        name: str,
        case: Case,
        chosen: NDArray[np.int64],
        trajectory: Trajectory,
        mark: int,
        target: Target | None,
        since: int = 0,
    ) -> Measurement:
        agreed = trajectory.agreed[mark - 1]
        shares = {int(n): float(agreed[chosen == n].mean()) for n in np.unique(chosen)}
        worst = min(shares, key=lambda number: shares[number])
        low, high = wilson(int(agreed.sum()), len(agreed))
        return Measurement(
            key,
            name,
            mark - since,
            len(shares),
            len(agreed),
            round(float(agreed.mean()), 5),
            round(low, 5),
            round(high, 5),
            (case.drawings.shapes[worst].name, round(shares[worst], 5)),
            convergence_times(np.maximum(trajectory.converged_at - since, 0)),
            None if target is None else target.share,
            0.0 if target is None else target.floor,
        )


def validate(engine: Engine, suite: Suite, runs: int, seed: int, say: Say = lambda _: None) -> dict[str, Any]:
    """Measures a model.

    Args:
        engine: the model's.
        suite: the cases to measure.
        runs: runs of each drawing.
        seed: of the random generator.
        say: called with each row as soon as it is measured.

    Returns:
        Plain values for metrics.json: `rows` as of `Measurement`, and `shortfall`, the sum over all rows.
    """
    rows = []
    for row in Evaluator(engine, suite, runs, seed).rows():
        say(row.text())
        rows.append(row)
    return {
        "runs_per_drawing": runs,
        "seed": seed,
        "rows": [row.as_json() for row in rows],
        "targets_held": f"{sum(r.holds for r in rows if r.target is not None)} of "
        f"{sum(r.target is not None for r in rows)}",
        "shortfall": round(sum(row.shortfall for row in rows), 5),
    }
