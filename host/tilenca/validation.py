"""What a trained model is worth: one table of measurements, the same for every recipe.

Everything runs on the integer network, bit-equal to the tile.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.drawings import Drawings
from tilenca.simulate import Conditions, Course, Engine, Schedule, Simulator

MARKS = (10, 30, 60)  # steps after which agreement is reported
SETTLED = MARKS[-1]  # from here on a wrong tile counts as a lapse
SCHEDULES: tuple[Schedule, ...] = ("random", "clock")
DISTURBED: dict[str, Conditions] = {
    "10 % of the messages lost, read as zero": Conditions("clock", loss=0.1, lost="zero"),
    "20 % of the messages lost, last one held": Conditions("clock", loss=0.2, lost="held"),
    "5 % of the tiles dead": Conditions("clock", dead=0.05),
}


def validate(
    engine: Engine, drawings: Drawings, runs: int, seed: int, say: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """Measures a model.

    Args:
        engine: the model, as the simulator wants it.
        drawings: what to show it.
        runs: runs of each drawing and schedule; longevity takes a tenth of them, over `20 * runs` steps.
        seed: of all chance in here.
        say: told what is being measured.

    Returns:
        Plain values for metrics.json; fractions are 0..1, times are in steps (updates per tile).
    """
    random = np.random.default_rng(seed)
    every = np.repeat(np.arange(len(drawings)), runs)
    metrics: dict[str, Any] = {"runs_per_drawing": runs, "agreement": {}, "settle": {}, "disturbed": {}}
    for schedule in SCHEDULES:
        say(f"agreement, {schedule}")
        course = Simulator(engine, drawings, every, Conditions(schedule), random).run(SETTLED)
        metrics["agreement"][schedule] = agreement_by_file(course, drawings, every)
        metrics["settle"][schedule] = settle_times(course.settled)
    for name, conditions in DISTURBED.items():
        say(name)
        course = Simulator(engine, drawings, every, conditions, random).run(SETTLED)
        metrics["disturbed"][name] = round(float(course.agreed[-1].mean()), 4)
    say("longevity")
    metrics["longevity"] = _longevity(engine, drawings, max(1, runs // 10), 20 * runs, random)
    say("switches")
    metrics["switches"] = _switches(engine, drawings, max(1, runs // 20), random)
    return metrics


def agreement_by_file(course: Course, drawings: Drawings, chosen: NDArray[np.int64]) -> dict[str, Any]:
    """Share of runs with every tile right at each mark, per shape file, and the worst drawing at the last."""
    table: dict[str, Any] = {}
    group_of_run = np.array(drawings.groups)[chosen]
    for group, source in enumerate(drawings.sources):
        mine = group_of_run == group
        row: dict[str, Any] = {
            f"{mark}": round(float(course.agreed[mark - 1][mine].mean()), 4) for mark in MARKS
        }
        last = course.agreed[MARKS[-1] - 1]
        worst = min(set(chosen[mine].tolist()), key=lambda drawing: float(last[chosen == drawing].mean()))
        row["worst"] = {
            "shape": drawings.shapes[worst].name,
            "agreement": round(float(last[chosen == worst].mean()), 4),
        }
        table[source["file"]] = row
    return table


def settle_times(settled: NDArray[np.float64]) -> dict[str, float | None]:
    """Median and 95th percentile of `Course.settled`; None where that many runs never settle."""
    settled = np.sort(settled)

    def quantile(share: float) -> float | None:
        value = settled[min(len(settled) - 1, int(np.ceil(share * len(settled))) - 1)]
        return float(value) if np.isfinite(value) else None

    return {"median": quantile(0.5), "p95": quantile(0.95)}


def _longevity(
    engine: Engine, drawings: Drawings, runs: int, steps: int, random: np.random.Generator
) -> dict[str, Any]:
    chosen = np.repeat(np.arange(len(drawings)), runs)
    course = Simulator(engine, drawings, chosen, Conditions("clock"), random).run(SETTLED + steps)
    lapsed = ~course.agreed[SETTLED - 1 :].all(axis=0)
    return {"runs": len(chosen), "steps": steps, "runs_with_a_lapse": int(lapsed.sum())}


def _switches(engine: Engine, drawings: Drawings, runs: int, random: np.random.Generator) -> dict[str, Any]:
    """Every change from one class to another within a file, on running tiles that nobody resets."""
    pairs = [
        (old, new)
        for old in range(len(drawings))
        for new in range(len(drawings))
        if drawings.groups[old] == drawings.groups[new] and drawings.classes[old] != drawings.classes[new]
    ] * runs
    if not pairs:
        return {"changes": 0, "agreement": None, "settle": {"median": None, "p95": None}}
    before, after = np.array(pairs, dtype=np.int64).T
    conditions = Conditions("clock")
    first = Simulator(engine, drawings, before, conditions, random)
    first.run(SETTLED)
    rebuilt = drawings.batch(after)
    states = engine.seed(len(rebuilt.sample))
    for run, (old, new) in enumerate(pairs):
        stays = drawings.overlap(old, new, random)
        kept = np.flatnonzero(stays >= 0)
        states[rebuilt.starts[run] + kept] = first.states[first.batch.starts[run] + stays[kept]]
    course = Simulator(engine, drawings, after, Conditions("clock", boot=0.0), random, states).run(SETTLED)
    return {
        "changes": len(pairs),
        "agreement": round(float(course.agreed[-1].mean()), 4),
        "settle": settle_times(course.settled),
    }
