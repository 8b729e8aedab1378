"""The rows of the report, and how they are read from the JSON of tilenca's commands."""

import math
import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from tilenca.evaluation.metrics import wilson

SHARE, STEPS, SECONDS, STATES, BYTES = "share", "updates", "s", "states", "bytes"
Words = tuple[str, ...]
DRAWN_STEPS, TOLD_STEPS = 30, (8, 10, 12)  # of a curve, and of these the ones that the table has too


@dataclass(frozen=True)
class Row:
    """One number.

    Attributes:
        key: its name, the same in every report.
        what: in words.
        value: the number; None: there is none, as for runs that never agree.
        unit: `SHARE` (of the runs, 0..1), `STEPS` (updates of every tile), `SECONDS` (of the tiles), or what
            is counted.
        low, high: 95 % confidence interval: Wilson's of a share, by order statistics of a median; None: not
            known.
        runs: from which it is.
        seed: of those.
        command: measures just this number again.
        across: the value of the axis that a figure draws it along; None: no figure does.
        line: the line of that figure.
        target: the least that was aimed at; None: nothing was.
        place: of a sweep, the value of each axis as text.
        only_drawn: whether it is in a figure, and not in the table.
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
    place: Mapping[str, str] = field(default_factory=dict)
    only_drawn: bool = False

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


def read_agreement(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca evaluate`, and a curve: the share that is right from an update to the end."""
    rows = read_evaluation(key, what, result, words)
    first, line = rows[0], what.split(", ", 1)[1]
    for step, value in enumerate(result["agreed_by_step"][:DRAWN_STEPS], 1):
        row = share(
            f"{key}.by@{step}",
            f"{what}: right from update {step} on",
            value,
            first.runs,
            first.seed,
            words,
        )
        rows.append(replace(row, across=step, line=line, only_drawn=step not in TOLD_STEPS))
    return rows


def read_plugging(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca evaluate --plug`: all tiles right, and the time from the change until then."""
    right, median = read_evaluation(key, what, result, words)
    times = result["seconds_to_agreement"]

    def row(name: str, which: str, value: float | None, low: float | None, high: float | None) -> Row:
        about = f"{what}: from the change until all tiles are right and stay so, {which}"
        return replace(right, key=f"{key}.{name}", what=about, value=value, unit=SECONDS, low=low, high=high)

    return [
        right,
        row("median_s", "median", times["median"], times["low"], times["high"]),
        row("p95_s", "95 % of the runs", times["p95"], None, None),
        replace(median, what=f"{what}: updates of the plugged tile until then, median"),
    ]


def read_states(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca emulate --check-states`: what was compared, and how much of it differs."""
    runs, command = result.get("runs", [result]), shlex.join(("tilenca", *words))
    told = [run["states"] for run in runs]
    found = [one["first_difference"] for one in told if one["first_difference"] is not None]
    first = f", the first one on tile {found[0]['tile']}, channel {found[0]['channel']}" if found else ""
    tiles = sum(len(run["tiles"]) for run in runs)
    rows = []
    for name, about, value, unit in (
        ("differences", f"drawings with a state that differs{first}", len(found), "drawings"),
        ("states", f"states compared, of {tiles} tiles", sum(one["states"] for one in told), STATES),
        ("bytes", "bytes compared", sum(one["bytes"] for one in told), BYTES),
        (
            "messages",
            "messages of neighbours that were read",
            sum(one["messages"] for one in told),
            "messages",
        ),
        (
            "again",
            "of these read again, since no newer one had come",
            sum(one["read_again"] for one in told),
            "messages",
        ),
    ):
        row = Row(
            f"{key}.{name}", f"{what}: {about}", value, unit, None, None, len(runs), seed_of(words), command
        )
        rows.append(row)
    return rows


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
    for time, when in (
        ("agreed_at_s", "from power to the last change of mind, slowest shape"),
        ("agreed_after_first_update_s", "the same from the first update of the last tile"),
    ):
        times = [shape[time] for shape in shapes]
        slowest = None if None in times else round(max(times), 3)
        rows.append(
            Row(
                f"{key}.{time}",
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
                across=_number(row[axes[0]]),
                line=", ".join(place[1:]),
                place={axis.replace("_", " "): _short(row[axis]) for axis in axes},
            )
        )
    return rows


def read_sweep_times(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """As `read_sweep`, but the updates until all tiles are right and stay so, median."""
    whole = [row for row in result["rows"] if row["shape"] == "all"]
    return [
        replace(row, value=told["median"], unit=STEPS, low=None, high=None)
        for row, told in zip(read_sweep(key, what, result, words), whole, strict=True)
    ]


def _short(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _number(value: float | str) -> float | None:
    """A value of an axis as a number: that of a size are its places; None for other words."""
    parts = str(value).split("x")
    try:
        return float(math.prod(map(float, parts)))
    except ValueError:
        return None


def read_curve(key: str, what: str, result: dict[str, Any], words: Words) -> list[Row]:
    """The rows of `tilenca simulate`: the share of the tiles that are right after each update."""
    seed, runs = seed_of(words), result["runs"]
    command = shlex.join(("tilenca", *words))
    line = what.partition(",")[0]

    def row(step: int, value: float) -> Row:
        name, after = f"{key}.cells@{step}", f"{what}: tiles right after {step} updates"
        return Row(
            name,
            after,
            value,
            SHARE,
            None,
            None,
            runs,
            seed,
            command,
            across=step,
            line=line,
            only_drawn=True,
        )

    return [row(step, value) for step, value in enumerate(result["by_step"]["cells_right"], 1)]


READERS = {
    "evaluation": read_evaluation,
    "suite": read_suite,
    "emulations": read_emulations,
    "agreement": read_agreement,
    "plugging": read_plugging,
    "states": read_states,
    "sweep": read_sweep,
    "sweep times": read_sweep_times,
    "curve": read_curve,
}


def seed_of(words: Sequence[str]) -> int:
    """The seed in a command's arguments."""
    return int(words[words.index("--seed") + 1])


def slug(text: str) -> str:
    """A text as a part of a key: lower case, digits, dots and dashes."""
    return re.sub(r"[^a-z0-9.]+", "-", text.lower()).strip("-")
