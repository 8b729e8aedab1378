"""The rows of the report, and how they are read from the JSON of tilenca's commands."""

import re
import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from tilenca.evaluation.metrics import wilson

SHARE, STEPS, SECONDS = "share", "updates", "s"
Words = tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """One number.

    Attributes:
        key: its name, the same in every report.
        what: in words.
        value: the number; None: there is none, as for runs that never agree.
        unit: `SHARE` (of the runs, 0..1), `STEPS` (updates of every tile) or `SECONDS` (of the tiles).
        low, high: 95 % confidence interval of a share (Wilson's); None for other units.
        runs: from which it is.
        seed: of those.
        command: measures just this number again.
        across: the value of the axis that a figure draws it along; None: no figure does.
        line: the line of that figure.
        target: the least that was aimed at; None: nothing was.
    """

    key: str
    what: str
    value: float | None
    unit: str
    low: float | None
    high: float | None
    runs: int
    seed: int
    command: str
    across: float | None = None
    line: str = ""
    target: float | None = None

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)


def share(key: str, what: str, value: float, runs: int, seed: int, words: Words) -> Row:
    """A row that is a share of the runs."""
    low, high = wilson(round(value * runs), runs)
    return Row(
        key, what, value, SHARE, round(low, 5), round(high, 5), runs, seed, shlex.join(("tilenca", *words))
    )


def read_evaluation(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca evaluate`: all tiles right, and the updates until they were."""
    seed, runs = seed_of(words), result["runs"] * len(result["per_shape"])
    right = share(f"{key}.right", f"{what}: all tiles right", result["total_agreement"], runs, seed, words)
    after = f"{what}: updates until all tiles are right and stay so, median"
    times = result["steps_to_agreement"]
    time = Row(f"{key}.median", after, times["median"], STEPS, None, None, runs, seed, right.command)
    return [right, time]


def read_suite(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca evaluate --suite`, each with the command for just that one."""
    del what  # every row has words of its own
    chosen = {number + plus for number, word in enumerate(words) if word == "--row" for plus in (0, 1)}
    all_rows = [word for number, word in enumerate(words) if number not in chosen]
    rows = []
    for row in result["metrics"]["rows"]:
        alone = shlex.join(("tilenca", *all_rows, "--row", f"={row['name']}"))
        rows.append(
            Row(
                f"{key}.{slug(row['name'])}@{row['steps']}",
                f"{row['name']}, after {row['steps']} updates",
                row["share"],
                SHARE,
                row["low"],
                row["high"],
                row["runs"],
                seed_of(words),
                alone,
                target=row["target"],
            )
        )
    return rows


def read_emulations(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca emulate`: all tiles right, and the seconds until they were."""
    shapes, seed = result.get("runs", [result]), seed_of(words)
    right = sum(shape["all_right"] for shape in shapes) / len(shapes)
    first = share(f"{key}.right", f"{what}: all tiles right", right, len(shapes), seed, words)
    rows = [first]
    for field, when in (
        ("agreed_at_s", "from power to the last change of mind, slowest shape"),
        ("agreed_after_first_update_s", "the same from the first update of the last tile"),
    ):
        times = [shape[field] for shape in shapes]
        slowest = None if None in times else round(max(times), 3)
        rows.append(
            Row(
                f"{key}.{field}",
                f"{what}: {when}",
                slowest,
                SECONDS,
                None,
                None,
                len(shapes),
                seed,
                first.command,
            )
        )
    return rows


def read_sweep(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca sweep` that have all drawings together, each with a command of its own."""
    axes = [words[n + 1].split("=")[0].replace("-", "_") for n, word in enumerate(words) if word == "--axis"]
    rows = []
    for row in result["rows"]:
        if row["shape"] != "all":
            continue
        place = [f"{axis.replace('_', ' ')} {row[axis]}" for axis in axes]
        across = row[axes[0]]
        rows.append(
            Row(
                f"{key}.{slug(', '.join(place))}",
                f"{what}: {', '.join(place)}",
                row["share"],
                SHARE,
                row["low"],
                row["high"],
                row["runs"],
                row["seed"],
                row["command"],
                across=float(across) if isinstance(across, int | float) else None,
                line=", ".join(place[1:]),
            )
        )
    return rows


def read_curve(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca simulate`: the share of the tiles that are right after each update."""
    seed, runs = seed_of(words), result["runs"]
    command = shlex.join(("tilenca", *words))
    line = what.partition(",")[0]

    def row(step: int, value: float) -> Row:
        name, after = f"{key}.cells@{step}", f"{what}: tiles right after {step} updates"
        return Row(name, after, value, SHARE, None, None, runs, seed, command, across=step, line=line)

    return [row(step, value) for step, value in enumerate(result["by_step"]["cells_right"], 1)]


READERS = {
    "evaluation": read_evaluation,
    "suite": read_suite,
    "emulations": read_emulations,
    "sweep": read_sweep,
    "curve": read_curve,
}


def seed_of(words: Sequence[str]) -> int:
    """The seed in a command's arguments."""
    return int(words[words.index("--seed") + 1])


def slug(text: str) -> str:
    """A text as a part of a key: lower case, digits, dots and dashes."""
    return re.sub(r"[^a-z0-9.]+", "-", text.lower()).strip("-")
