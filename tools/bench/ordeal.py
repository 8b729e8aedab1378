"""Twenty emulated tiles through everything that hands, cables and power do to them: `make soak TIME=600`.

Drawings come and go tile by tile, cables lose, invert and are cut, tiles lose their power, are reset into the
boot loader, which a programmer may begin to talk to, hear noise on USB and get new settings. Now and then all
is mended and left alone. Then every tile has to run, to name the drawing, and to have settings that it was
given, and both ends of a link have to count the same frames. A tile's updates never go back unless it
restarted. The memory of this process must not grow.
"""

import argparse
import sys
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

from bench.ordeal_checks import Findings, MemoryWatch, memory_mb
from bench.ordeal_table import PATIENCE, UPDATES, Ordeal
from bench.publish import publish
from tilenca.base import paths
from tilenca.base.commit import commit
from tilenca.base.processors import processors

BETWEEN_S, DEEDS_TO_CALM = 0.25, 12
TELL_EVERY_S = 60.0
BEGIN, END = (
    "<!-- soak: made by `make soak TIME=3600 WRITE=docs/BENCHMARKS.md`, do not edit -->",
    "<!-- /soak -->",
)


def ordeal(
    elf: Path,
    seconds: float,
    seed: int,
    threads: int,
    on_calm: Callable[[float, Findings], None] | None = None,
) -> Findings:
    """Runs the table for so many emulated seconds.

    Args:
        elf: the image.
        seconds: of the tiles' time.
        seed: of all that happens.
        threads: that share the work; they change nothing.
        on_calm: called with the tiles' time and what was found so far, each time that all was left alone.

    Raises:
        TilencaError: the image cannot be run.
    """
    table = Ordeal(elf, seed, threads)
    with table.array:
        table.calm()
        while table.array.time_s < seconds:
            for _ in range(DEEDS_TO_CALM):
                table.deed()
                table.run(BETWEEN_S)
            table.calm()
            if on_calm is not None:
                on_calm(table.array.time_s, table.findings)
    return table.findings


class Progress:
    """Tells on stderr how far it is, and watches the memory."""

    def __init__(self, seconds: float) -> None:
        self.memory = MemoryWatch()
        self._seconds, self._told_s = seconds, time.monotonic()

    def __call__(self, time_s: float, found: Findings) -> None:
        """After each time that all was left alone."""
        passed = self.memory.look(time_s / self._seconds)
        if passed or time.monotonic() - self._told_s > TELL_EVERY_S:
            self._told_s = time.monotonic()
            line = f"{time_s:.0f} of {self._seconds:.0f} s of the tiles' time; {found.summary()}"
            print(f"{line}; {memory_mb():.0f} MB", file=sys.stderr, flush=True)


def section(found: Findings, seconds: float, seed: int, memory: MemoryWatch) -> str:
    """The result in Markdown."""
    deeds = ", ".join(f"{kind} {times:,}" for kind, times in sorted(found.deeds.items()))
    rows = [
        ("deeds", f"{sum(found.deeds.values()):,}: {deeds}"),
        ("left alone and looked at", f"{found.calms:,} times"),
        ("both ends of a link compared", f"{found.links:,} times"),
        ("frames lost meanwhile", f"{found.lost:,} of {found.frames:,}"),
        (f"drawings not named by all tiles within {UPDATES} updates", f"{len(found.late)}"),
        (f"the same, within {UPDATES * (1 + PATIENCE)}; tiles stuck; settings that nobody gave; counts that "
         "do not add up", f"{len(found.broken)}"),
        ("memory of the process", memory.words()),
    ]  # fmt: skip
    lines = ["| twenty emulated tiles through everything | |", "|---|---|"]
    lines += [f"| {name} | {value} |" for name, value in rows]
    when = f"{datetime.now(UTC).date().isoformat()}, commit {commit()}"
    return "\n".join([*lines, "", f"{seconds:,.0f} s of the tiles' time, seed {seed}; {when}."])


def main() -> int:
    """Prints what was found; status 1 if anything was broken."""
    parser = argparse.ArgumentParser(description="Twenty emulated tiles through everything that can happen.")
    add = parser.add_argument
    add("--seconds", type=float, default=600.0, help="of the tiles' time (default: %(default)s)")
    add("--seed", type=int, default=1, help="of all that happens (default: %(default)s)")
    add("--write", type=Path, metavar="F", help="put the result into this document")
    args = parser.parse_args()
    progress = Progress(args.seconds)
    found = ordeal(paths.FIRMWARE_ELF, args.seconds, args.seed, processors(), progress)
    if (drift := progress.memory.drift()) is not None:
        found.broken.append(drift)
    publish(section(found, args.seconds, args.seed, progress.memory), args.write, BEGIN, END)
    for line in (*found.broken, *found.late):
        print(line)
    return int(bool(found.broken))


if __name__ == "__main__":
    sys.exit(main())
