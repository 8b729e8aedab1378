"""Compares the figures of a run of `make bench` with the last ones, and keeps them: python -m bench.history.

A figure that got worse by more than its noise is shown in red. The noise is the range of a figure's own
rounds, of this run or of the last one, whichever is wider; exact counts have none. Exact counts are compared
with those of any machine, the others with those of the same kind.
"""

import argparse
import csv
import platform
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console
from rich.table import Table

from bench.figures import NOTED, Figure, noted
from tilenca.base.commit import commit
from tilenca.base.paths import ROOT
from tilenca.base.processors import processors

HISTORY = ROOT / "docs" / "bench-history.csv"
COLUMNS = ("date", "commit", "machine", "figure", "value", "unit", "noise", "better")
MORE, LESS = "more", "less"
WIDTH = 160  # where the table goes to no terminal


@dataclass(frozen=True)
class Run:
    """When, of what and where figures were measured.

    Attributes:
        date: ISO 8601, a day of UTC.
        commit: as `commit()` says it.
        machine: the kind of processor, and how many of it.
    """

    date: str
    commit: str
    machine: str


@dataclass(frozen=True)
class Entry:
    """A figure of a run."""

    run: Run
    figure: Figure


@dataclass(frozen=True)
class Change:
    """A figure, and what it was before; None: it is new."""

    now: Figure
    last: Entry | None

    @property
    def share(self) -> float | None:
        """By how much it grew, as a share of the last one; None where there is none to compare with."""
        if self.last is None or self.last.figure.value == 0:
            return None
        return self.now.value / self.last.figure.value - 1

    @property
    def slid(self) -> bool:
        """Whether it got worse by more than noise."""
        if self.last is None:
            return False
        before = self.last.figure
        worse = self.now.value - before.value
        if self.now.more_is_better:
            worse = -worse
        return worse > max(self.now.noise, before.noise) * abs(before.value)


def this_run() -> Run:
    """Today, this tree and this machine."""
    return Run(datetime.now(UTC).date().isoformat(), commit(), machine())


def machine(cpuinfo: Path = Path("/proc/cpuinfo")) -> str:
    """The kind of processor, and how many of it this process may use."""
    try:
        lines = cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {processors()} cores"


def read(path: Path) -> list[Entry]:
    """The kept entries, oldest first; none if there is no such file.

    Raises:
        ValueError: a line is none of ours; with its number.
    """
    if not path.exists():
        return []
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        rows = csv.reader(file)
        try:
            if tuple(next(rows, ())) != COLUMNS:
                raise ValueError(f"the columns are not {', '.join(COLUMNS)}")
            return [_entry(row) for row in rows]
        except (ValueError, csv.Error) as error:
            raise ValueError(f"{path}:{max(rows.line_num, 1)}: {error}") from None


def _entry(row: Sequence[str]) -> Entry:
    try:
        date, commit_, where, name, value, unit, noise, better = row
        figure = Figure(name, float(value), unit, float(noise), {MORE: True, LESS: False}[better])
    except (ValueError, KeyError):
        raise ValueError("no figure of a benchmark") from None
    return Entry(Run(date, commit_, where), figure)


def append(path: Path, run: Run, figures: Iterable[Figure]) -> None:
    """Adds the figures of a run to the file, which is begun if there is none."""
    begins = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        if begins:
            rows.writerow(COLUMNS)
        for one in figures:
            better = MORE if one.more_is_better else LESS
            numbers = f"{one.value:.6g}" if one.noise else f"{one.value:.12g}", one.unit, f"{one.noise:.4g}"
            rows.writerow((run.date, run.commit, run.machine, one.name, *numbers, better))


def changes(figures: Iterable[Figure], kept: Sequence[Entry], where: str) -> list[Change]:
    """Each figure beside the last one that it can be compared with.

    Args:
        figures: of this run.
        kept: the history, oldest first.
        where: this machine.
    """
    found = []
    for now in figures:
        last = [
            entry
            for entry in kept
            if entry.figure.name == now.name and (now.noise == 0 or entry.run.machine == where)
        ]
        found.append(Change(now, last[-1] if last else None))
    return found


def table(found: Sequence[Change]) -> Table:
    """What the run shows at its end."""
    shown = Table("figure", "last", "now", "change", "noise", title="make bench")
    for one in found:
        last = "" if one.last is None else f"{one.last.figure.value:,.6g} ({one.last.run.commit})"
        share = one.share
        change = "new" if one.last is None else ("" if share is None else f"{share:+.1%}")
        noise = "exact" if one.now.noise == 0 else f"{one.now.noise:.1%}"
        now = f"{one.now.value:,.6g} {one.now.unit}"
        words = (one.now.name, last, now, change + (" WORSE" if one.slid else ""), noise)
        shown.add_row(*words, style="red" if one.slid else None)
    return shown


def main() -> int:
    """Prints the table and adds the run to the history."""
    parser = argparse.ArgumentParser(description="Compares the noted figures with the last run's.")
    parser.add_argument("--history", type=Path, default=HISTORY, help="the kept file (default: %(default)s)")
    args = parser.parse_args()
    figures = noted()
    try:
        found = changes(figures, read(args.history), machine())
    except ValueError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    if not found:
        print("bench: nothing was noted; run `make bench`", file=sys.stderr)
        return 2
    console = Console() if sys.stdout.isatty() else Console(width=WIDTH)
    console.print(table(found))
    append(args.history, this_run(), figures)
    NOTED.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
