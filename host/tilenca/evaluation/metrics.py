"""What a trained model is worth: one table of measurements, the same for every recipe.

Everything runs on the firmware's own core. A run counts as right when *every* tile shows the right class.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.suites import Exam, Paper
from tilenca.simulator.engine import Engine
from tilenca.simulator.simulator import Conditions, Course, Fault, Schedule, Simulator
from tilenca.simulator.transitions import rebuild, rebuild_tile_by_tile

MARKS = (10, 30, 60)  # steps after which agreement is reported
SETTLING = (8, 14)  # steps within which half, and nearly all, of the runs are to settle
SETTLED = MARKS[-1]  # from here on a wrong tile counts as a lapse
LONG = 1000
LEAST_LASTING = 3000  # steps without a lapse, in short measurements; slow drifts show after two thousand
SCHEDULES: dict[Schedule, str] = {"random": "the paper's sampler", "clock": "the tiles' own clocks"}
CLOCK = Conditions("clock")
FaultKind = Literal["dead", "stuck", "away"]
Say = Callable[[str], None]


@dataclass(frozen=True)
class Target:
    """What a row must reach: a share of the runs, and at least `floor` of those of every drawing."""

    share: float
    floor: float = 0.0


PERFECT = 0.9995  # 1.000 as it is printed
TARGETS = {
    "drawn": Target(PERFECT, 0.998),
    "settled in 8": Target(0.5),
    "settled in 14": Target(0.95),
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
class Row:
    """One line of the table.

    Attributes:
        key: what kind of question it is.
        name: what was asked.
        steps: after how many steps (updates per tile) since the start or the last change.
        drawings: how many drawings.
        runs: how many runs of all of them.
        share: of the runs in which every tile was right.
        low, high: 95 % confidence interval of it (Wilson's), for these drawings.
        worst: the drawing that did worst, and its share.
        settle: steps until all tiles were right and stayed so: median, 95 % (None: never); None where that
            makes no sense.
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
    settle: dict[str, float | None] | None
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


def settle_times(settled: NDArray[np.float64]) -> dict[str, float | None]:
    """Median and 95th percentile of `Course.settled`; None where that many runs never settle."""
    settled = np.sort(settled)

    def quantile(share: float) -> float | None:
        value = settled[min(len(settled) - 1, int(np.ceil(share * len(settled))) - 1)]
        return float(value) if np.isfinite(value) else None

    return {"median": quantile(0.5), "p95": quantile(0.95)}


class Examiner:
    """Measures one model.

    Args:
        engine: the model, as the simulator wants it.
        exam: what to ask.
        runs: runs of each drawing; longevity takes a fifth of them over 20 steps for each.
        seed: of all chance in here.
    """

    def __init__(self, engine: Engine, exam: Exam, runs: int, seed: int) -> None:
        self.engine, self.exam, self.runs = engine, exam, runs
        self.random = np.random.default_rng(seed)

    def short_rows(self) -> Iterator[Row]:
        """What training wants to know on its way: the clocks only, and nothing that takes long."""
        yield from self.agreement({"clock": SCHEDULES["clock"]})
        for part in (self.sizes, self.disturbed, self.unknown):
            yield from part()
        yield from self.changes(one_by_one=False)
        yield from self.longevity()

    def rows(self) -> Iterator[Row]:
        """All measurements, in the order of the table."""
        yield from self.agreement()
        yield from self.sizes()
        yield from self.disturbed()
        yield from self.unknown()
        yield from self.changes()
        yield from self.longevity()

    def agreement(self, schedules: Mapping[Schedule, str] = SCHEDULES) -> Iterator[Row]:
        """The files' drawings on both schedules, and how soon the first file's settle; larger ones."""
        for paper in self.exam.drawn:
            for schedule, name in schedules.items():
                course, chosen = self._run(paper, Conditions(schedule), SETTLED)
                for mark in MARKS:
                    target = TARGETS[paper.kind] if mark > MARKS[0] else None
                    yield self._row("drawings", f"{paper.name}, {name}", paper, chosen, course, mark, target)
                if paper is self.exam.drawn[0] and schedule == "clock":
                    for steps in SETTLING:
                        soon = Course((course.settled <= steps).astype(np.float32)[None])
                        target = TARGETS[f"settled in {steps}"]
                        row = self._row("settling", f"{paper.name}, settled", paper, chosen, soon, 1, target)
                        yield replace(row, steps=steps, settle=None)
        for paper in self.exam.larger:
            course, chosen = self._run(paper, CLOCK, paper.steps)
            yield self._row("sizes", paper.name, paper, chosen, course, paper.steps, TARGETS[paper.kind])

    def sizes(self) -> Iterator[Row]:
        """Other sizes."""
        for paper in self.exam.sizes:
            runs = self.runs if paper.held_out else max(2, self.runs // 25)
            course, chosen = self._run(paper, CLOCK, paper.steps, runs)
            target = TARGETS[paper.kind] if paper.aimed else None
            yield self._row("sizes", paper.name, paper, chosen, course, paper.steps, target)

    def disturbed(self) -> Iterator[Row]:
        """Lost messages, and tiles that are missing, dead, stuck, or away for a while."""
        drawn, lost = self.exam.drawn[0], TARGETS["lost"]
        for name, conditions in (
            ("20 % of the messages lost, read as zero", Conditions("clock", loss=0.2, lost="zero")),
            ("50 % of the messages lost, last one held", Conditions("clock", loss=0.5, lost="held")),
        ):
            course, chosen = self._run(drawn, conditions, SETTLED)
            yield self._row("lost", name, drawn, chosen, course, SETTLED, lost)
        if (damaged := self.exam.damaged) is not None:
            name = "one tile missing, where that leaves no doubt about the class"
            course, chosen = self._run(damaged, CLOCK, SETTLED, max(2, self.runs // 5))
            target = TARGETS["damaged"] if damaged.aimed else None
            yield self._row("damaged", name, damaged, chosen, course, SETTLED, target)
        large = [n for n, size in enumerate(drawn.drawings.sizes) if size > 1]
        if not large:
            return  # of a single tile nobody is left to ask
        several = replace(drawn, drawings=drawn.drawings.chosen(large))
        faults: tuple[tuple[str, FaultKind, int, int | None, Target | None], ...] = (
            ("any one tile dead, the others asked", "dead", 0, None, None),
            ("any one tile stuck after 5 steps, the others asked", "stuck", 5, None, None),
            ("any one tile off from step 30 to 60, back again", "away", 30, SETTLED, TARGETS["away"]),
        )
        for name, kind, begin, end, target in faults:
            since = end or begin
            course, chosen = self._run(several, CLOCK, since + SETTLED, fault=(kind, begin, end))
            yield self._row("faults", name, several, chosen, course, since + SETTLED, target, since)

    def unknown(self) -> Iterator[Row]:
        """Drawings of no class: right is what shows the dash on every tile."""
        for paper in self.exam.unknown:
            each = max(2, 10 * self.runs // len(paper.drawings))
            course, chosen = self._run(paper, CLOCK, paper.steps, each)
            target = TARGETS[paper.kind] if paper.aimed else None
            yield self._row("unknown", paper.name, paper, chosen, course, paper.steps, target)

    def changes(self, one_by_one: bool = True) -> Iterator[Row]:
        """Every change from one class to another on running tiles that nobody resets."""
        drawn = self.exam.drawn[0]
        for paper, how, change, target in (
            (drawn, "at once", rebuild, "switch"),
            *(((drawn, "tile by tile", rebuild_tile_by_tile, "tile by tile"),) if one_by_one else ()),
            *((paper, "at once", rebuild, "larger switch") for paper in self.exam.larger),
        ):
            runs = max(1, self.runs // (10 if how == "at once" else 50))
            changed = change(self.engine, paper.drawings, runs, SETTLED, paper.steps, self.random)
            if changed is not None:
                course, chosen = changed
                name = f"{paper.name}, changes to every other class {how}"
                yield self._row("changes", name, paper, chosen, course, paper.steps, TARGETS[target])

    def longevity(self) -> Iterator[Row]:
        """Long runs: who is right after 1000 steps, and who is never wrong again after having settled."""
        drawn = self.exam.drawn[0]
        course, chosen = self._run(drawn, CLOCK, LONG, max(1, self.runs // 5))
        name = f"{drawn.name}, {SCHEDULES['clock']}"
        yield self._row("longevity", name, drawn, chosen, course, LONG, TARGETS["long"])
        steps = max(LEAST_LASTING, 20 * self.runs)
        for paper in (self.exam.drawn[0], *self.exam.larger[-1:]):
            each = max(1, -(-self.runs // (5 * len(paper.drawings))))
            course, chosen = self._run(paper, CLOCK, paper.steps + steps, each)
            kept = Course(course.right[paper.steps - 1 :].min(axis=0, keepdims=True))
            name = f"{paper.name}, no lapse in {steps} steps more"
            row = self._row("longevity", name, paper, chosen, kept, 1, TARGETS["longevity"])
            yield replace(row, steps=paper.steps + steps, settle=None)

    def _run(
        self,
        paper: Paper,
        conditions: Conditions,
        steps: int,
        runs: int | None = None,
        fault: tuple[FaultKind, int, int | None] | None = None,
    ) -> tuple[Course, NDArray[np.int64]]:
        chosen = np.repeat(np.arange(len(paper.drawings)), self.runs if runs is None else runs)
        faults = None
        if fault is not None:
            kind, begin, end = fault
            faults = Fault(kind, self.random.integers(paper.drawings.sizes[chosen]), begin, end)
        simulator = Simulator(self.engine, paper.drawings, chosen, conditions, self.random, fault=faults)
        return simulator.run(steps), chosen

    def _row(
        self,
        key: str,
        name: str,
        paper: Paper,
        chosen: NDArray[np.int64],
        course: Course,
        mark: int,
        target: Target | None,
        since: int = 0,
    ) -> Row:
        agreed = course.agreed[mark - 1]
        shares = {int(n): float(agreed[chosen == n].mean()) for n in np.unique(chosen)}
        worst = min(shares, key=lambda number: shares[number])
        low, high = wilson(int(agreed.sum()), len(agreed))
        return Row(
            key,
            name,
            mark - since,
            len(shares),
            len(agreed),
            round(float(agreed.mean()), 5),
            round(low, 5),
            round(high, 5),
            (paper.drawings.shapes[worst].name, round(shares[worst], 5)),
            settle_times(np.maximum(course.settled - since, 0)),
            None if target is None else target.share,
            0.0 if target is None else target.floor,
        )


def validate(engine: Engine, exam: Exam, runs: int, seed: int, say: Say = lambda _: None) -> dict[str, Any]:
    """Measures a model.

    Args:
        engine: the model, as the simulator wants it.
        exam: what to ask.
        runs: runs of each drawing.
        seed: of all chance in here.
        say: told each row as it is known.

    Returns:
        Plain values for metrics.json: `rows` as of `Row`, and `shortfall`, the sum of theirs.
    """
    rows = []
    for row in Examiner(engine, exam, runs, seed).rows():
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
