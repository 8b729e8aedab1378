"""Rows of a model's table with a share that a test chooses."""

from tilenca.evaluation.metrics import Measurement, Target


def row(share: float, target: Target | None = None, worst: float | None = None) -> Measurement:
    settle = {"median": 7.0, "p95": None}
    aim = (None, 0.0) if target is None else (target.share, target.floor)
    return Measurement(
        "drawings",
        "some",
        60,
        1,
        100,
        share,
        0.0,
        1.0,
        ("4", share if worst is None else worst),
        settle,
        *aim,
    )
