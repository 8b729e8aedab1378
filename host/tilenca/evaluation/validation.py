"""The whole table of measurements of a model, as plain values."""

from collections.abc import Callable, Sequence
from typing import Any

from tilenca.evaluation.evaluator import Evaluator
from tilenca.evaluation.suites import Suite
from tilenca.simulator.engine import Engine

Say = Callable[[str], None]


def validate(
    engine: Engine,
    suite: Suite,
    runs: int,
    seed: int,
    say: Say = lambda _: None,
    only: Sequence[str] = (),
) -> dict[str, Any]:
    """Measures a model.

    Args:
        engine: the model's.
        suite: the cases to measure.
        runs: runs of each drawing.
        seed: of all chance.
        say: called with each row as soon as it is measured.
        only: see `Evaluator`.

    Returns:
        Plain values for metrics.json: `rows` as of `Measurement`, and `shortfall`, the sum over all rows.
    """
    rows = []
    for row in Evaluator(engine, suite, runs, seed, only).rows():
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
