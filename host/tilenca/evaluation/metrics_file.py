"""The measurements beside a model, `metrics.json`, as every command reads them."""

from pathlib import Path
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_json

METRICS_FILE = "metrics.json"
MOST = 1e12  # of iterations, and of a shortfall


def read_metrics(folder: Path) -> dict[str, Any]:
    """The metrics of a model; empty where there are none.

    Args:
        folder: of the model.

    Returns:
        As `tilenca.evaluation.validation.validate` made them, and the end of the training. `rows`,
        `targets_held`, `shortfall` and `iterations` are of the right types where they are there.

    Raises:
        UsageError: they are damaged.
    """
    path = folder / METRICS_FILE
    try:
        metrics = read_json(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; make it a file that can be read") from error
    except ValueError as error:
        raise UsageError(f"{path}: cannot be read ({error}); get it again, or train again") from error
    if not isinstance(metrics, dict) or not _are_metrics(metrics):
        raise UsageError(f"{path}: not the metrics of a model; get them again, or train again")
    return metrics


def _are_metrics(metrics: dict[str, Any]) -> bool:
    numbers, rows = (metrics.get("iterations"), metrics.get("shortfall")), metrics.get("rows", [])
    known = all(number is None or _is_in(number, MOST) for number in numbers)
    known &= isinstance(metrics.get("targets_held", ""), str)
    return known and isinstance(rows, list) and all(map(_is_row, rows))


def _is_row(row: object) -> bool:
    match row:
        case {"key": str(), "name": str(), "share": share, "target": None, "holds": bool()}:
            return _is_in(share, 1)
        case {"key": str(), "name": str(), "share": share, "target": target, "holds": bool()}:
            return _is_in(share, 1) and _is_in(target, 1)
    return False


def _is_in(number: object, most: float) -> bool:
    """Whether it is a number from 0 to `most`."""
    return isinstance(number, int | float) and 0 <= number <= most
