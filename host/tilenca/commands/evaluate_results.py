"""What `tilenca evaluate` has measured, as a document and as a table."""

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.evaluation.metrics import answer_shares, convergence_times, median_interval
from tilenca.model.file import Model
from tilenca.shapes.batch import Drawings
from tilenca.views.table import table


@dataclass(frozen=True)
class RunResults:
    """The measured runs, one entry per run.

    Attributes:
        chosen: (R,) the drawing.
        right: (R,) share of tiles that show the right class at the end.
        converged_at: (R,) step from which all were right to the end; infinite for none.
        regressed: (R,) whether a tile was wrong after step 60, in runs longer than that.
        answers: (R,) what all tiles showed at the end, see `Simulator.answers`; None: not measured.
        agreed_s: (R,) seconds from the last tile's switch-on until all were right to the end, infinite for
            none; None: the engine knows steps only.
    """

    chosen: NDArray[np.int64]
    right: NDArray[np.float32]
    converged_at: NDArray[np.float64]
    regressed: NDArray[np.bool_]
    answers: NDArray[np.int64] | None = None
    agreed_s: NDArray[np.float64] | None = None


def report_of(
    args: argparse.Namespace, model: Model, drawings: Drawings, runs: int, outcome: RunResults
) -> dict[str, Any]:
    """The JSON document.

    Args:
        args: of the command.
        model: that was measured.
        drawings: that were run.
        runs: of each.
        outcome: of all runs.
    """
    agreed = outcome.right >= 1.0
    per_shape = []
    for number, shape in enumerate(drawings.shapes):
        mine = outcome.chosen == number
        per_shape.append(
            {
                "label": shape.label,
                "name": shape.name,
                "file": drawings.sources[drawings.groups[number]]["file"],
                "grid": shape.grid,
                "cells_right": round(float(outcome.right[mine].mean()), 6),
                "total_agreement": round(float(agreed[mine].mean()), 6),
                "steps_to_agreement": convergence_times(outcome.converged_at[mine]),
            }
        )
    return {
        "model": f"{model.model_id:04X}",
        "engine": args.engine,
        "schedule": args.schedule,
        "steps": args.steps,
        "runs": runs,
        "cells_right": round(float(outcome.right.mean()), 6),
        "total_agreement": round(float(agreed.mean()), 6),
        "missed": _missed(drawings, outcome),
        "steps_to_agreement": convergence_times(outcome.converged_at),
        "agreed_by_step": _agreed_by_step(outcome.converged_at, args.steps),
        "seconds_to_agreement": _seconds(outcome.agreed_s),
        "runs_with_a_regression": int(outcome.regressed.sum()),
        "per_shape": per_shape,
    }


def _agreed_by_step(converged_at: NDArray[np.float64], steps: int) -> list[float]:
    """The share of the runs in which all tiles are right from each step to the end."""
    return [round(float((converged_at <= step).mean()), 6) for step in range(1, steps + 1)]


def _seconds(agreed_s: NDArray[np.float64] | None) -> dict[str, float | None] | None:
    """Median with its interval, and 95 % of the runs; None where that many never agree."""
    if agreed_s is None:
        return None
    low, high = median_interval(agreed_s)
    times = convergence_times(agreed_s) | {"low": low, "high": high}
    return {name: round(s, 4) if s is not None and np.isfinite(s) else None for name, s in times.items()}


def _missed(drawings: Drawings, outcome: RunResults) -> dict[str, float] | None:
    """The shares of the runs in which all tiles show the dash, all another class, or tiles differ."""
    if outcome.answers is None:
        return None
    shares = answer_shares(drawings, outcome.chosen, outcome.answers)
    return dict(zip(("dash", "wrong", "split"), shares, strict=True))


def print_report(report: dict[str, Any]) -> None:
    """Prints the document as a table."""

    def texts(times: dict[str, float | None]) -> list[str]:
        return ["never" if value is None else f"{value:.0f}" for value in times.values()]

    def cells(name: str, file: str, row: dict[str, Any]) -> list[str]:
        shares = f"{row['cells_right']:.4f}", f"{row['total_agreement']:.4f}"
        return [name, file, *shares, *texts(row["steps_to_agreement"])]

    rows = [cells(row["name"], row["file"], row) for row in report["per_shape"]]
    rows.append(cells("all", "", report))
    print(
        f"model {report['model']}, engine {report['engine']}, schedule {report['schedule']}: after "
        f"{report['steps']} steps, {report['runs']} runs per shape; median and 95 %: steps until all tiles "
        "are right and stay so"
    )
    print(table(("shape", "file", "cells right", "all right", "median", "95 %"), rows))
    if report["missed"] is not None:
        shares = ", ".join(f"{kind} {share:.4f}" for kind, share in report["missed"].items())
        print(f"not right: {shares} of the runs; split: tiles of one body show different answers")
    if report["seconds_to_agreement"] is not None:
        times = {
            name: "never" if s is None else f"{s:.3f} s" for name, s in report["seconds_to_agreement"].items()
        }
        print(
            f"from the last tile's power to agreement: median {times['median']} ({times['low']} to "
            f"{times['high']}), 95 % {times['p95']}"
        )
