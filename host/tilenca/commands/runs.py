"""`tilenca runs`: which trainings lie in a folder, what they reached, and their curves over each other."""

import argparse
import json
import os
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, TypeVar

from tilenca.base.errors import UsageError
from tilenca.base.stdio import warn
from tilenca.commands.plot import HISTORY_FILE, read_history
from tilenca.evaluation.metrics_file import read_metrics
from tilenca.model.file import CHECKPOINTS, checkpoints, load_model
from tilenca.training.sessions import FILE, Session, sessions_of
from tilenca.views.table import table

T = TypeVar("T")
Rows = list[list[float | None]]
DONE, RESUMABLE, RUNNING = "done", "resumable", "running"
MODELS = Path("models")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument(
        "folders",
        nargs="*",
        type=Path,
        default=[MODELS],
        metavar="DIR",
        help=f"folders with trainings in them, at any depth ({MODELS})",
    )
    parser.add_argument(
        "--plot", type=Path, metavar="FILE", help="draw their curves over each other, as .png or .svg"
    )
    parser.add_argument("--json", action="store_true", help="print the list as one JSON document")


def run(args: argparse.Namespace) -> int:
    """Lists the trainings; draws them if asked."""
    for folder in args.folders:
        if not folder.is_dir():
            raise UsageError(f"{folder}: no such folder; give one with trainings in it, such as {MODELS}")
    found = [(folder, about) for folder in _folders(args.folders) if (about := _about(folder)) is not None]
    if not found:
        raise UsageError(
            f"{' '.join(map(str, args.folders))}: no training there; begin one: tilenca train --out DIR"
        )
    if args.plot is not None:
        from tilenca.views.plots import plot_runs

        names = _names([folder for folder, _ in found])
        curves = {f"{names[folder]}: {_title(about)}": _curve(folder) for folder, about in found}
        plot_runs(curves, args.plot)
    runs = [about for _, about in found]
    if args.json:
        print(json.dumps({"runs": runs, "plot": None if args.plot is None else str(args.plot)}))
        return 0
    print(
        table(
            ("run", "state", "recipe", "seed", "iterations", "time", "targets", "missed"), list(_lines(runs))
        )
    )
    if args.plot is not None:
        print(args.plot)
    for about in runs:
        if about["state"] == RESUMABLE and about["command"]:
            warn(f"to go on with {about['run']}: {about['command']} --resume")
    return 0


def _folders(roots: list[Path]) -> list[Path]:
    """The folders at or below the roots in which something was trained, sorted; each root is walked once."""
    found = set()
    for root in roots:
        for place, _, names in os.walk(root):
            if any(name in ("model.json", FILE) or fnmatch(name, CHECKPOINTS) for name in names):
                found.add(Path(place))
    return sorted(found)


def _about(folder: Path) -> dict[str, Any] | None:
    """One training as plain values; None: the folder has none, or a damaged one, which is told."""
    sessions = sessions_of(folder)
    running = any(one.is_running for one in sessions)
    try:
        if checkpoints(folder):
            about = _unfinished(folder)
        elif (folder / "model.json").exists():
            about = _finished(folder)
        elif running:
            about = _begun()
        else:
            raise UsageError(f"{folder}: a training there ended before there was anything to keep")
    except UsageError as error:
        warn(f"note: {error}")
        return None
    times = [session.seconds for session in sessions if session.seconds is not None]
    state = about["state"]
    return {
        "run": str(folder),
        **about,
        "state": RUNNING if state != DONE and running else state,
        "recipe": _recipe(about["recipe"], sessions),
        "seconds": round(sum(times), 1) if times else None,
        "began": sessions[0].began if sessions else None,
        "command": sessions[-1].command if sessions else None,
    }


def _recipe(known: str | None, sessions: list[Session]) -> str | None:
    return known or (sessions[-1].recipe if sessions else None)


def _finished(folder: Path) -> dict[str, Any]:
    model = load_model(folder)
    metrics = read_metrics(folder)
    metadata = model.metadata
    recipe, seed = _if_a(str, metadata.get("recipe_name")), _if_a(int, metadata.get("seed"))
    plan = _if_a(dict, metadata.get("recipe")) or {}
    aimed = [row for row in metrics.get("rows", []) if row["target"] is not None]
    return {
        "state": DONE,
        "model_id": f"{model.model_id:04X}",
        "labels": list(model.labels),
        "recipe": recipe,
        "seeds": [] if seed is None else [seed],
        "iterations": metrics.get("iterations"),
        "planned": _if_a(int, plan.get("iterations")),
        "targets": len(aimed),
        "held": sum(row["holds"] for row in aimed),
        "missed": [{"key": row["key"], "name": row["name"]} for row in aimed if not row["holds"]],
        "shortfall": metrics.get("shortfall"),
    }


def _if_a(kind: type[T], value: object) -> T | None:
    return value if isinstance(value, kind) else None


def _begun() -> dict[str, Any]:
    """A training before its first checkpoint."""
    nothing = ("model_id", "recipe", "iterations", "planned", "targets", "held", "shortfall")
    return {"state": RUNNING, "labels": [], "seeds": [], "missed": [], **dict.fromkeys(nothing)}


def _unfinished(folder: Path) -> dict[str, Any]:
    from tilenca.training.checkpoint import glance

    states = [glance(path) for path in checkpoints(folder)]
    last = states[0]
    shortfalls = [state["checks"][-1][1] for state in states if state["checks"]]
    return {
        "state": RESUMABLE,
        "model_id": None,
        "labels": list(last["config"]["labels"]),
        "recipe": None,
        "seeds": [state["config"]["seed"] for state in states],
        "iterations": min(state["iteration"] for state in states),
        "planned": last["config"]["recipe"]["iterations"],
        "targets": None,
        "held": None,
        "missed": [],
        "shortfall": min(shortfalls) if shortfalls else None,
    }


def _curve(folder: Path) -> Rows:
    """The history of a training; none where it is damaged, which is told."""
    try:
        return _history(folder)
    except UsageError as error:
        warn(f"note: {error}")
        return []


def _history(folder: Path) -> Rows:
    """(iteration, loss, agreement) of a training; of several unfinished seeds those of the first."""
    if unfinished := checkpoints(folder):
        from tilenca.training.checkpoint import glance

        return [list(row) for row in glance(unfinished[0])["history"]]
    if not (folder / HISTORY_FILE).exists():
        return []
    columns, rows = read_history(folder / HISTORY_FILE)
    if missing := {"iteration", "loss", "agreement"}.difference(columns):
        raise UsageError(f"{folder / HISTORY_FILE}: has no {' and no '.join(sorted(missing))}; train again")
    places = [columns.index(name) for name in ("iteration", "loss", "agreement")]
    return [[row[place] for place in places] for row in rows]


def _title(about: dict[str, Any]) -> str:
    return f"{about['recipe'] or '?'}, seed {_seeds(about)}"


def _names(folders: list[Path]) -> dict[Path, str]:
    """Short names that tell the folders apart: as many of their last parts as that takes."""
    for parts in range(1, max(len(folder.resolve().parts) for folder in folders)):
        names = {folder: str(Path(*folder.resolve().parts[-parts:])) for folder in folders}
        if len(set(names.values())) == len(folders):
            return names
    return {folder: str(folder) for folder in folders}


def _seeds(about: dict[str, Any]) -> str:
    return ",".join(map(str, about["seeds"])) or "?"


def _lines(runs: list[dict[str, Any]]) -> Iterator[list[str]]:
    for about in runs:
        done, planned = about["iterations"], about["planned"]
        early = about["state"] == DONE and done is not None and planned is not None and done < planned
        of = "" if done == planned or early or planned is None else f" of {planned:,}"
        held, missed = about["held"], dict.fromkeys(row["key"] for row in about["missed"])
        yield [
            about["run"],
            about["state"],
            about["recipe"] or "?",
            _seeds(about),
            ("?" if done is None else f"{done:,}{of}") + (" (early)" if early else ""),
            "?" if about["seconds"] is None else _time(about["seconds"]),
            f"{held} of {about['targets']}" if about["targets"] else "",
            ", ".join(missed),
        ]


def _time(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"
