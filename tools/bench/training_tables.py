"""Writes the tables of docs/TRAINING.md and the shipped models' cards: bench.training_tables [--check].

Both follow from the models' metrics, and from the cost of an update on a tile, which changes with the
firmware. --measure measures models again, with their cards' seeds, for instance after a change of the tiles'
behaviour. Each table stands between `<!-- NAME -->` and `<!-- /NAME -->`.
"""

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tilenca.base import paths
from tilenca.evaluation.card import render_card
from tilenca.model import cost
from tilenca.model.file import load_model

DOCUMENT = paths.ROOT / "docs" / "TRAINING.md"
MODELS = paths.ROOT / "models"
WIDTHS = ("digits-40", "digits-64", "digits-drawn")  # trained by the same recipe
HANDS = ("digits", "digits-wide")  # of any hand; the second goes on from the first
TASKS = ("hex", "letters", "pentominoes")
# Rows to show of a width or a task: a short name, the end of the row's name, and its steps.
ROWS = {
    "5x4 @60": ("the tiles' own clocks", 60),
    "@1000": ("the tiles' own clocks", 1000),
    "12x10 @100": ("12x10", 100),
    "held-out forms": ("held-out forms, 5x3 to 14x12", 100),
    "20x16 @200": ("20x16, never trained on", 200),
    "changes": ("changes to every other class at once", 60),
    "half of the messages lost": ("50 % of the messages lost, last one held", 60),
    "one tile missing": ("one tile missing, new pairs", 60),
    "random drawings": ("random drawings, forms never trained on", 60),
    "other strokes": ("other choices of the same strokes, forms never trained on", 60),
}


def metrics_of(model: str) -> dict[str, Any]:
    """The metrics of a shipped model."""
    metrics: dict[str, Any] = json.loads((MODELS / model / "metrics.json").read_text(encoding="utf-8"))
    return metrics


def share(model: str, wanted: tuple[str, int], asked_only: bool = False) -> str:
    """The share of the first row whose name ends with this; with `asked_only` only rows with a target."""
    ending, steps = wanted
    for row in metrics_of(model)["rows"]:
        if row["name"].endswith(ending) and row["steps"] == steps and (row["target"] or not asked_only):
            return f"{row['share']:.3f}"
    return ""


def by_paper(name: str, steps: int) -> str:
    """The share of the paper's recipe, which trained on fewer kinds of drawings than the digits' model."""
    drawings = name.removesuffix(", the tiles' own clocks")
    new = f"{drawings}, never trained on"
    return share("paper", (name, steps)) or share("paper", (new, steps))


def digits() -> Iterator[list[str]]:
    """Every row of the digits' model, with the paper's recipe and the one for drawings alone beside it."""
    yield [
        "digits, share of runs with every tile right",
        "after steps",
        "the paper's recipe",
        "`models/digits-drawn`",
        "`models/digits`",
        "`models/digits-wide`",
        "target",
    ]
    for row in metrics_of("digits")["rows"]:
        if row["key"] == "drawings" and row["steps"] == 10:
            continue
        target = "" if row["target"] is None else f"{row['target']:.3f}{'' if row['holds'] else ' missed'}"
        name = re.sub(r"digits(-(\w+))?\.toml", lambda match: match[2] or "5x4", row["name"])
        place = row["name"], row["steps"]
        yield [
            name,
            str(row["steps"]),
            by_paper(*place),
            share("digits-drawn", place),
            f"{row['share']:.3f}",
            share("digits-wide", place),
            target,
        ]


def compared(models: tuple[str, ...]) -> Iterator[list[str]]:
    """One line a model: its cost on a tile, and its scores."""
    names = [
        name
        for name, wanted in ROWS.items()
        if any(share(model, wanted, asked_only=True) for model in models)
    ]
    yield ["model", "state", "hidden", "flash", "work per update", "targets held", *names]
    for name in models:
        model = load_model(MODELS / name)
        costs = cost.check(model.dimensions, len(model.labels)).as_json()
        yield [
            f"[{name}](../models/{name}/README.md)",
            str(costs["channels"]),
            str(costs["hidden1"]),
            f"{costs['flash_bytes']:,} bytes",
            f"{costs['update_ms']} ms",
            str(metrics_of(name)["targets_held"]),
            *(share(name, ROWS[column], asked_only=True) for column in names),
        ]


def directions() -> Iterator[list[str]]:
    """The rows about missing tiles of the model that says where they are."""
    yield ["`models/damage`", "after steps", "of", "share", "95 % interval", "target"]
    for row in metrics_of("damage")["rows"]:
        if row["key"] == "directions":
            target = (
                "" if row["target"] is None else f"{row['target']:.2f}{'' if row['holds'] else ' missed'}"
            )
            share, low, high = (f"{row[name]:.3f}" for name in ("share", "low", "high"))
            yield [row["name"], str(row["steps"]), f"{row['runs']:,}", share, f"{low} to {high}", target]


TABLES: dict[str, Callable[[], Iterator[list[str]]]] = {
    "digits": digits,
    "widths": lambda: compared(WIDTHS),
    "hands": lambda: compared(HANDS),
    "tasks": lambda: compared(TASKS),
    "directions": directions,
}


def rendered(text: str) -> str:
    """The document with its tables made anew.

    Raises:
        ValueError: it has no place for one of them.
    """
    for name, rows in TABLES.items():
        lines = [f"| {' | '.join(row)} |" for row in rows()]
        lines.insert(1, "|---" * (lines[0].count(" | ") + 1) + "|")
        table = "\n".join((f"<!-- {name} -->", *lines, f"<!-- /{name} -->"))
        before, begin, rest = text.partition(f"<!-- {name} -->")
        _, end, after = rest.partition(f"<!-- /{name} -->")
        if not (begin and end):
            raise ValueError(f"{DOCUMENT}: no place <!-- {name} --> for a table")
        text = before + table + after
    return text


def measure(name: str) -> None:
    """Measures a shipped model again for its card, and writes the results into its metrics."""
    metrics, model = metrics_of(name), load_model(MODELS / name)
    words = [sys.executable, "-m", "tilenca.cli", "evaluate", "--suite", "--json"]
    words += ["--model", str(MODELS / name)]
    words += ["--shapes", *(str(paths.ROOT / place) for place in model.metadata["shapes"])]
    words += ["--runs", str(metrics["runs_per_drawing"]), "--seed", str(metrics["seed"])]
    answer = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    new = metrics | json.loads(answer)["metrics"]
    (MODELS / name / "metrics.json").write_text(json.dumps(new, indent=2) + "\n", encoding="utf-8")


def documents() -> dict[Path, str]:
    """The text that every document should have.

    Raises:
        ValueError: see `rendered`.
    """
    cards = {
        path.parent / "README.md": render_card(load_model(path.parent), metrics_of(path.parent.name))
        for path in sorted(MODELS.glob("*/model.json"))
    }
    return {DOCUMENT: rendered(DOCUMENT.read_text(encoding="utf-8"))} | cards


def main() -> int:
    """Writes the documents; with --check exits 1 where one differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing, exit 1 where one differs")
    parser.add_argument(
        "--measure", nargs="+", default=[], metavar="MODEL", help="measure these models again first"
    )
    args = parser.parse_args()
    for name in args.measure:
        measure(name)
    differ = {path: text for path, text in documents().items() if path.read_text(encoding="utf-8") != text}
    for path, text in differ.items():
        if args.check:
            print(
                f"{path}: differs from the models' metrics; run bench.training_tables",
                file=sys.stderr,
            )
        else:
            path.write_text(text, encoding="utf-8")
    return int(args.check and bool(differ))


if __name__ == "__main__":
    sys.exit(main())
