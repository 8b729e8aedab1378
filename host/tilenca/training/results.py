"""Writes a trained model, its card, metrics and history, but never over a better one."""

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.parsing import read_json
from tilenca.base.stdio import warn
from tilenca.evaluation.card import render_card
from tilenca.evaluation.metrics_file import METRICS_FILE, read_metrics
from tilenca.model.file import Model


@dataclass(frozen=True)
class Result:
    """The result of a training.

    Attributes:
        model: the integer model.
        metrics: of `validation.validate`, and the end of the training.
        history: (iteration, loss, agreement) of each interval.
        checks: (iteration, shortfall, share by kind of measurement) of the short measurements.
    """

    model: Model
    metrics: dict[str, Any]
    history: list[tuple[int, float, float]]
    checks: list[tuple[int, float, dict[str, float]]]


def keep(directory: Path, result: Result) -> Path:
    """Writes the model; returns where.

    A better model of the same classes stays; the new one then goes into a folder beside its files.

    Raises:
        TilencaError: the disk is full or not writable.
    """
    try:
        if (better := _better(directory, result)) is not None:
            place = directory / f"model-{result.model.model_id:04X}"
            warn(
                f"{directory}: holds the better model (short of its targets by {better:.4f}, the new one by "
                f"{result.metrics['shortfall']:.4f}) and keeps it; the new one is in {place}"
            )
            directory = place
        _write(directory, result)
    except OSError as error:
        raise TilencaError(
            f"{directory}: cannot write the model ({error.strerror}); free some space and --resume"
        ) from error
    return directory


def _better(directory: Path, result: Result) -> float | None:
    """The shortfall of the model of the same drawings that lies there, if it is smaller."""
    try:
        shortfall = float(read_metrics(directory)["shortfall"])
        old = read_json((directory / "model.json").read_text(encoding="utf-8"))
        same = (
            tuple(old["labels"]) == result.model.labels
            and old.get("metadata", old.get("made"))["sources"] == result.model.metadata["sources"]
        )
    except (UsageError, OSError, ValueError, KeyError, TypeError):
        return None
    return shortfall if same and shortfall < result.metrics["shortfall"] else None


def _write(directory: Path, result: Result) -> None:
    result.model.save(directory)
    (directory / METRICS_FILE).write_text(json.dumps(result.metrics, indent=2) + "\n", encoding="utf-8")
    (directory / "history.csv").write_text(history_csv(result), encoding="utf-8")
    (directory / "README.md").write_text(render_card(result.model, result.metrics), encoding="utf-8")


def history_table(result: Result) -> tuple[list[str], list[list[float | None]]]:
    """Columns, and a row for every entry of the history and every measurement; None for no value."""
    kinds = list(dict.fromkeys(kind for _, _, shares in result.checks for kind in shares))
    means = {iteration: means for iteration, *means in result.history}
    checks = {iteration: shares for iteration, _, shares in result.checks}
    rows: list[list[float | None]] = [
        [
            iteration,
            *means.get(iteration, (None, None)),
            *(checks.get(iteration, {}).get(kind) for kind in kinds),
        ]
        for iteration in sorted(means.keys() | checks.keys())
    ]
    return ["iteration", "loss", "agreement", *(f"@{kind}" for kind in kinds)], rows


def history_csv(result: Result) -> str:
    """The history as a file."""
    columns, rows = history_table(result)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for iteration, *values in rows:
        writer.writerow([iteration, *("" if x is None else f"{x:.5f}" for x in values)])
    return text.getvalue()
