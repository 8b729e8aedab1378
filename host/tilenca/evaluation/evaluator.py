"""Measures a trained model: the same table of measurements for every recipe, on the firmware's own core."""

import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.best_guess import best_share, guessed_share
from tilenca.evaluation.cases import VERY_LARGE_STEPS, Case
from tilenca.evaluation.metrics import TARGETS, Measurement, Runs, Target, measure, target_of
from tilenca.evaluation.missing import missing_rows
from tilenca.evaluation.suites import Suite
from tilenca.shapes.file import UNKNOWN
from tilenca.simulator.conditions import Conditions, Fault, FaultKind, ScheduleKind
from tilenca.simulator.engine import Engine
from tilenca.simulator.simulator import Simulator, Trajectory
from tilenca.simulator.transitions import Order, Way, rebuild

MARKS = (10, 30, 60)  # steps after which agreement is reported
CONVERGENCE_STEPS = (8, 14)  # steps within which half, and nearly all, of the runs are to converge
CONVERGED_BY = MARKS[-1]  # from here on a wrong tile counts as a regression
LONG = 1000
LEAST_LASTING = 3000  # steps without a regression, in short measurements; slow drifts show after two thousand
SCHEDULES: dict[ScheduleKind, str] = {
    "listing": "the paper's listing",
    "random": "two random halves a step",
    "clock": "the tiles' own clocks",
}
GUESSES = 2000  # runs from which the share of the best guess follows
BELOW_BEST = 0.03  # how far tiles may be below it
CLOCK = Conditions("clock")
AT_ONCE = Way("at once")
ORDERS: tuple[Order, ...] = ("adding first", "mixed", "removing first")
SLOW_WAYS = tuple(Way(order, between) for order in ORDERS for between in (1, 15, 40))
DEAD = "any one tile dead, the others asked"
# The faults to measure: name, kind, first step, step of its end, and the kind of the target.
FAULTS: tuple[tuple[str, FaultKind, int, int | None, str | None], ...] = (
    (DEAD, "dead", 0, None, None),
    ("any one tile stuck after 5 steps, the others asked", "stuck", 5, None, None),
    ("any one tile off from step 30 to 60, back again", "away", 30, CONVERGED_BY, "away"),
)


class Evaluator:
    """Measures one model.

    Args:
        engine: the model's.
        suite: the cases to measure.
        runs: runs of each drawing; longevity takes a fifth of them over 20 steps for each.
        seed: of all chance. Every row has its own, so that it is the same alone and in the table.
        only: texts of which a row's name must have one, or be one with `=` before it; none: all rows.
    """

    def __init__(self, engine: Engine, suite: Suite, runs: int, seed: int, only: Sequence[str] = ()) -> None:
        self.engine, self.suite, self.runs = engine, suite, runs
        self._seed, self._only = seed, tuple(only)

    def short_rows(self) -> Iterator[Measurement]:
        """The measurements during training: the clocks only, and nothing that takes long."""
        yield from self.agreement({"clock": SCHEDULES["clock"]})
        for part in (self.varied, self.sizes, self.disturbed, self.missing, self.unknown, self.agreeing):
            yield from part()
        yield from self.changes(one_by_one=False)
        yield from self.longevity()

    def rows(self) -> Iterator[Measurement]:
        """All measurements, in the order of the table."""
        yield from self.agreement()
        yield from self.varied()
        yield from self.sizes()
        yield from self.disturbed()
        yield from self.missing()
        yield from self.unknown()
        yield from self.agreeing()
        yield from self.changes(one_by_one=self.suite.slow_changes)
        yield from self.longevity()

    def agreement(self, schedules: Mapping[ScheduleKind, str] = SCHEDULES) -> Iterator[Measurement]:
        """The files' drawings on all schedules, the first file's time to converge, and larger drawings."""
        for case in self.suite.drawn:
            for schedule, way in schedules.items():
                name, converged = f"{case.name}, {way}", f"{case.name}, converged"
                timed = case is self.suite.drawn[0] and schedule == "clock" and self._wanted(converged)
                if not (timed or self._wanted(name)):
                    continue
                runs = self._run(name, case, Conditions(schedule), *MARKS)
                for mark in MARKS if self._wanted(name) else ():
                    target = target_of(case.kind) if mark > MARKS[0] else None
                    yield measure("drawings", name, runs, mark, target)
                if timed:
                    yield from _convergence(converged, runs)
        for case in self._those(self.suite.larger):
            runs = self._run(case.name, case, CLOCK, case.steps)
            yield measure("sizes", case.name, runs, case.steps, target_of(case.kind))

    def varied(self) -> Iterator[Measurement]:
        """Drawings by another hand: variants of held-out forms."""
        for case in self._those([] if self.suite.varied is None else [self.suite.varied]):
            runs = self._run(case.name, case, CLOCK, case.steps, each=max(2, self.runs // 50))
            yield measure("varied", case.name, runs, case.steps, _target_if_aimed(case))

    def sizes(self) -> Iterator[Measurement]:
        """Other sizes."""
        for case in self._those(self.suite.sizes):
            many = case.held_out and case.steps <= VERY_LARGE_STEPS
            each = self.runs if many else max(2, self.runs // 25)
            runs = self._run(case.name, case, CLOCK, case.steps, each=each)
            yield measure("sizes", case.name, runs, case.steps, _target_if_aimed(case))

    def disturbed(self) -> Iterator[Measurement]:
        """Lost messages, and tiles that are missing, dead, stuck, or away for a while."""
        drawn = self.suite.drawn[0]
        for name, conditions in (
            ("20 % of the messages lost, read as zero", Conditions("clock", loss=0.2, lost="zero")),
            ("50 % of the messages lost, last one held", Conditions("clock", loss=0.5, lost="held")),
        ):
            if self._wanted(name):
                runs = self._run(name, drawn, conditions, CONVERGED_BY)
                yield measure("lost", name, runs, CONVERGED_BY, target_of("lost"))
        for case in self._those(self.suite.damaged):
            each = max(2, 10 * self.runs // len(case.drawings))
            runs = self._run(case.name, case, CLOCK, case.steps, each=each)
            yield measure("damaged", case.name, runs, case.steps, _target_if_aimed(case))
        yield from self.dead()
        large = [n for n, size in enumerate(drawn.drawings.sizes) if size > 1]
        if large:  # without a single tile no tile is left to measure
            yield from self._faults(replace(drawn, drawings=drawn.drawings.chosen(large)))

    def _faults(self, case: Case) -> Iterator[Measurement]:
        """One tile that is dead, stuck, or away for a while."""
        chosen = self._every_drawing(case, self.runs)
        for name, kind, begin, end, target in FAULTS:
            if not self._wanted(name):
                continue
            tile = self._chance(f"{name}, which tile").integers(case.drawings.sizes[chosen])
            fault = Fault(kind, tile, begin, end)
            changed_at = begin if end is None else end
            mark = changed_at + CONVERGED_BY
            runs = self._run(name, case, Conditions("clock", fault=fault), mark)
            row = measure(
                "faults", name, runs, mark, None if target is None else target_of(target), changed_at
            )
            yield replace(row, best=round(best_share(case.drawings.shapes), 5)) if name == DEAD else row

    def dead(self) -> Iterator[Measurement]:
        """Many dead tiles: thick strokes hold together, and pieces of thin ones can only guess."""
        for case in self._those(self.suite.dead):
            runs = self._run(case.name, case, Conditions("clock", dead=case.dead), case.steps)
            if case.kind in TARGETS:
                yield measure("dead", case.name, runs, case.steps, _target_if_aimed(case))
                continue
            best = round(guessed_share(case.drawings.shapes, case.dead, GUESSES, self._seed), 5)
            target = Target(round(best - BELOW_BEST, 5)) if case.aimed else None
            row = measure("dead", case.name, runs, case.steps, target)
            yield replace(row, best=best)

    def missing(self) -> Iterator[Measurement]:
        """Where tiles say that one is missing."""
        for asked in self.suite.missing:
            if any(self._wanted(name) for name in asked.rows.values()):
                rows = missing_rows(self.engine, asked, self.runs, self._chance)
                yield from (row for row in rows if self._wanted(row.name))

    def agreeing(self) -> Iterator[Measurement]:
        """Any drawing: a run is right if all tiles show one answer, or for a class that one or the dash."""
        labels = self.suite.drawn[0].drawings.labels
        for case in self._those(self.suite.agreeing):
            each = max(2, 10 * self.runs // len(case.drawings))
            runs = self._run(case.name, case, CLOCK, case.steps, each=each)
            given, own = runs.answers[case.steps], case.drawings.classes[runs.chosen]
            right = given >= 0
            if case.kind == "one tile too many":
                right &= (given == own) | (given == (labels.index(UNKNOWN) if UNKNOWN in labels else own))
            told = {1: np.where(right, own, given)}
            asked = replace(runs, trajectory=Trajectory(right.astype(np.float32)[None]), answers=told)
            row = measure("one answer", case.name, asked, 1, _target_if_aimed(case))
            yield replace(row, steps=case.steps, convergence=None)

    def unknown(self) -> Iterator[Measurement]:
        """Drawings of no class: a run is right if every tile shows the dash."""
        for case in self._those(self.suite.unknown):
            each = max(2, 10 * self.runs // len(case.drawings))
            runs = self._run(case.name, case, CLOCK, case.steps, each=each)
            yield measure("unknown", case.name, runs, case.steps, _target_if_aimed(case))

    def changes(self, one_by_one: bool = True) -> Iterator[Measurement]:
        """Every change from one class to another on running tiles, without a reset.

        Steps count from the last change.
        """
        drawn = self.suite.drawn[0]
        for case, way, target in (
            (drawn, AT_ONCE, "switch"),
            *((drawn, way, "tile by tile") for way in SLOW_WAYS if one_by_one),
            *((case, AT_ONCE, "larger switch") for case in self.suite.larger),
        ):
            name = f"{case.name}, changes to every other class{_way_name(way)}"
            if not self._wanted(name):
                continue
            each, random = max(1, self.runs // (10 if way is AT_ONCE else 40)), self._chance(name)
            runs = self._changed(case, each, random, way)
            if runs is not None:
                yield measure("changes", name, runs, case.steps, target_of(target))

    def longevity(self) -> Iterator[Measurement]:
        """Long runs: all right after 1000 steps, and without a regression after convergence."""
        drawn = self.suite.drawn[0]
        name = f"{drawn.name}, {SCHEDULES['clock']}"
        if self._wanted(name):
            runs = self._run(f"{name}, long", drawn, CLOCK, LONG, each=max(1, self.runs // 5))
            yield measure("longevity", name, runs, LONG, target_of("long"))
        steps = max(LEAST_LASTING, 20 * self.runs)
        for case in (self.suite.drawn[0], *self.suite.larger[-1:]):
            name = f"{case.name}, no regression in {steps} more steps"
            if not self._wanted(name):
                continue
            each = max(1, -(-self.runs // (5 * len(case.drawings))))
            runs = self._run(name, case, CLOCK, case.steps + steps, each=each)
            always = Trajectory(runs.trajectory.right[case.steps - 1 :].min(axis=0, keepdims=True))
            row = measure("longevity", name, replace(runs, trajectory=always), 1, target_of("longevity"))
            yield replace(row, steps=case.steps + steps, convergence=None)

    def _wanted(self, name: str) -> bool:
        return not self._only or any(
            name == text[1:] if text.startswith("=") else text in name for text in self._only
        )

    def _those(self, cases: Iterable[Case]) -> Iterator[Case]:
        """The cases whose rows are wanted."""
        return (case for case in cases if self._wanted(case.name))

    def _chance(self, name: str) -> np.random.Generator:
        """The chance of a row."""
        return np.random.default_rng((self._seed, zlib.crc32(name.encode())))

    def _run(
        self, name: str, case: Case, conditions: Conditions, *marks: int, each: int | None = None
    ) -> Runs:
        """Runs every drawing of a case, `each` times or as often as the evaluator does.

        Args:
            name: of the row, whose chance the runs have.
            case: the drawings.
            conditions: of all runs.
            marks: the steps after which all tiles are asked for their answer, ascending; the last one ends
                the runs.
            each: how often; None: as often as the evaluator does.
        """
        chosen = self._every_drawing(case, self.runs if each is None else each)
        simulator = Simulator(self.engine, case.drawings, chosen, conditions, self._chance(name))
        parts, answers = [], {}
        for before, mark in pairwise((0, *marks)):
            parts.append(simulator.run(mark - before).right)
            answers[mark] = simulator.answers()
        return Runs(case, chosen, Trajectory(np.concatenate(parts)), answers)

    def _changed(self, case: Case, each: int, random: np.random.Generator, way: Way) -> Runs | None:
        """Every drawing rebuilt into those of other classes; None where there is only one class."""
        changed = rebuild(self.engine, case.drawings, each, CONVERGED_BY, case.steps, random, way)
        if changed is None:
            return None
        return Runs(case, changed.chosen, changed.trajectory, {case.steps: changed.answers})

    @staticmethod
    def _every_drawing(case: Case, each: int) -> NDArray[np.int64]:
        return np.repeat(np.arange(len(case.drawings)), each)


def _way_name(way: Way) -> str:
    if way.order == "at once":
        return " at once"
    return f", {way.order}, a tile every {way.between} update{'s' if way.between > 1 else ''}"


def _convergence(name: str, runs: Runs) -> Iterator[Measurement]:
    """The shares of the runs that have converged within certain numbers of steps."""
    for steps in CONVERGENCE_STEPS:
        soon = Trajectory((runs.trajectory.converged_at <= steps).astype(np.float32)[None])
        row = measure(
            "convergence", name, replace(runs, trajectory=soon), 1, target_of(f"converged in {steps}")
        )
        yield replace(row, steps=steps, convergence=None)


def _target_if_aimed(case: Case) -> Target | None:
    return target_of(case.kind) if case.aimed else None
