"""The emulator's speed on the real firmware, at its own pace of an update every 20 ms.

Processor time, since other load changes it least; the best of a few rounds in which all cases take turns.
"""

import os
import random
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from bench.figures import note, of_rounds
from bench.reference import COMMIT, host_of_reference, native
from tilenca.base.errors import BuildError
from tilenca.base.paths import ROOT
from tilenca.emulator import Array
from tilenca.emulator.translator import make
from tilenca.emulator.wiring import cables
from tilenca.shapes.file import Shape

EIGHT = "####\n#..#\n####\n#..#\n####"
SIZES = {1: (1, 1), 2: (1, 2), 5: (1, 5), 10: (2, 5), 20: (5, 4), 50: (5, 10), 100: (10, 10), 200: (10, 20)}
PPM = 3000.0
WORDS = {"eight": "sixteen tiles in an 8", "block": "twenty tiles in a block"}
SECOND_CORE = 1.5  # cores that two threads must have had
SWITCHED_ON_S = 0.2
# Until all tiles run and agree; and what is measured then, of all tiles together.
WARM_UP_S, MEASURED_TILE_S = 0.6, 12.0
# What libsimavr runs of this firmware before it takes one of its sleeps for the end, in MHz seconds.
SIMAVR_MEGACYCLES, CLOCK_MHZ, PATIENCE_S = 2, 16, 30


class Case:
    """Tiles of the firmware in one shape, run again and again in the same way."""

    def __init__(
        self, elf: Path, grid: str, threads: int = 1, translated: bool = True, start_s: float | None = None
    ) -> None:
        """With `start_s`, only so long from the start is measured."""
        self._elf, self._threads, self._translated = elf, threads, translated
        self._start_s = start_s
        self._shape = Shape("8", tuple(grid.split("\n")), "8")
        self.tiles = len(self._shape.cells)
        self.cpu_s: list[float] = []  # per emulated second
        self.wall_s: list[float] = []

    def measure(self) -> None:
        """Runs it once more."""
        draw = random.Random(1)
        ppm = [draw.uniform(-PPM, PPM) for _ in range(self.tiles)]
        spread_s = 0 if self._start_s else SWITCHED_ON_S
        switch_on_s = [draw.uniform(0, spread_s) for _ in range(self.tiles)]
        with Array(
            self._elf, self.tiles, cables(self._shape), ppm, switch_on_s,
            threads=self._threads, translated=self._translated,
        ) as array:  # fmt: skip
            seconds = self._start_s or max(MEASURED_TILE_S / self.tiles, 0.1)
            array.run(0 if self._start_s else WARM_UP_S)
            cpu_s, wall_s = time.process_time(), time.perf_counter()
            array.run(seconds)
            self.cpu_s.append((time.process_time() - cpu_s) / seconds)
            self.wall_s.append((time.perf_counter() - wall_s) / seconds)

    @property
    def cost_s(self) -> float:
        """Processor seconds per emulated second, at best."""
        return min(self.cpu_s)

    @property
    def times_real_time(self) -> float:
        """Emulated seconds in a second, at best."""
        return 1 / min(self.wall_s)


class Against:
    """This emulator and that of the reference on the same tiles, in turns, each in a process of its own."""

    def __init__(self, elf: Path, grid: str, before: Path | None) -> None:
        self._elf, self._before = elf, before
        self._case = {"grid": grid, "warmUpS": WARM_UP_S, "measuredS": MEASURED_TILE_S / grid.count("#")}
        self._ours_s: list[float] = []
        self._theirs_s: list[float] = []

    def measure(self) -> None:
        """Runs both once more."""
        if self._before is not None:
            theirs = native(self._before, self._case | {"translated": False}, self._elf)
            ours = native(ROOT / "host", self._case | {"translated": True}, self._elf)
            self._theirs_s.append(theirs["cpuS"])
            self._ours_s.append(ours["cpuS"])

    def note(self, name: str) -> None:
        """Keeps the ratio of each round."""
        note_ratios(f"{WORDS[name]}, against {COMMIT}", self._theirs_s, self._ours_s)

    def row(self, name: str) -> tuple[str, str, str]:
        """The ratio of their processor times: the median of the rounds, as in the history."""
        what = f"firmware, {WORDS[name]}, processor time at {COMMIT}"
        if self._before is None:
            return what, "not measured: this clone has no history", "3.5 times as much"
        return what, f"{median(ratios(self._theirs_s, self._ours_s)):.2f} times as much", "3.5 times as much"


def note_ratios(name: str, slow_s: Sequence[float], fast_s: Sequence[float]) -> None:
    """Keeps how many times the second is as fast as the first, of rounds in which they took turns."""
    if len(slow_s) > 1:
        note(of_rounds(f"emulator: {name}", ratios(slow_s, fast_s), "times as fast"))


def ratios(slow_s: Sequence[float], fast_s: Sequence[float]) -> list[float]:
    """(R,) how many times the second is as fast as the first in each of R rounds."""
    return [slow / fast for slow, fast in zip(slow_s, fast_s, strict=True)]


def block(rows: int, columns: int) -> str:
    """The drawing of a full block."""
    return "\n".join(["#" * columns] * rows)


def simavr_s(program: Path, elf: Path) -> float:
    """Processor seconds that libsimavr takes for an emulated second of one tile."""
    command = [str(program), str(elf), str(SIMAVR_MEGACYCLES)]
    done = subprocess.run(command, capture_output=True, check=True, text=True, timeout=PATIENCE_S)
    return CLOCK_MHZ / float(done.stderr.splitlines()[-1])


def measure(rounds: int, elf: Path, simavr: Path | None) -> list[tuple[str, str, str]]:
    """Name, figure and target; one row per figure."""
    try:
        make(elf)
    except BuildError as error:
        print(f"bench: {error}; the interpreter is measured twice")
    twenty = block(*SIZES[20])
    plain = {"eight": Case(elf, EIGHT, translated=False), "block": Case(elf, twenty, translated=False)}
    start_s = SIMAVR_MEGACYCLES / CLOCK_MHZ
    starts = [Case(elf, "#", translated=translated, start_s=start_s) for translated in (True, False)]
    fast = {"eight": Case(elf, EIGHT), "block": Case(elf, twenty)}
    two = {"eight": Case(elf, EIGHT, threads=2), "block": Case(elf, twenty, threads=2)}
    sized = {count: Case(elf, block(*size)) for count, size in SIZES.items()}
    before = host_of_reference()
    against = {name: Against(elf, grid, before) for name, grid in (("eight", EIGHT), ("block", twenty))}
    theirs = []
    for _ in range(rounds):
        for pair in against.values():
            pair.measure()
        for case in (*plain.values(), *starts, *fast.values(), *two.values(), *sized.values()):
            case.measure()
        if simavr is not None:
            theirs.append(simavr_s(simavr, elf))
    note_ratios("one tile, against libsimavr", theirs, starts[0].cpu_s[: len(theirs)])
    for name, words in WORDS.items():
        note_ratios(f"{words}, against the interpreter", plain[name].cpu_s, fast[name].cpu_s)
    each_s = [cpu_s / SIZES[20][0] / SIZES[20][1] for cpu_s in sized[20].cpu_s]
    note_ratios("one of twenty tiles, against a lone one", sized[1].cpu_s, each_s)
    for name, pair in against.items():
        pair.note(name)
    return [
        *rows(plain, fast, two, starts, sized, theirs),
        *(pair.row(name) for name, pair in against.items()),
    ]


def two_threads(one: Case, two: Case) -> str:
    """How much sooner two threads are done; they are compared only where a second core was free."""
    ratios = [cpu_s / wall_s for cpu_s, wall_s in zip(two.cpu_s, two.wall_s, strict=True)]
    if max(ratios) < SECOND_CORE:
        return "not measured: other programs had the second core"
    return (
        f"{two.times_real_time:.1f} times real time, {min(one.wall_s) / min(two.wall_s):.2f} times one thread"
    )


def rows(
    plain: dict[str, Case], fast: dict[str, Case], two: dict[str, Case], starts: Sequence[Case],
    sized: dict[int, Case], theirs: Sequence[float],
) -> list[tuple[str, str, str]]:  # fmt: skip
    """The measurements as rows of the table."""
    one = sized[1].cost_s
    beside = (
        f"{min(theirs) / starts[0].cost_s:.1f} times libsimavr at its start; "
        f"interpreted {min(theirs) / starts[1].cost_s:.1f} times"
        if theirs
        else "libsimavr is not installed"
    )
    found = [("firmware, one tile, one thread", f"{1 / one:.0f} times real time, {beside}", "")]
    for name, words in WORDS.items():
        cost, interpreted = fast[name].cost_s, plain[name].cost_s
        found.append(
            (
                f"firmware, {words}, one thread",
                f"{1 / cost:.1f} times real time; interpreted {1 / interpreted:.1f} times",
                "",
            )
        )
        found.append(
            (
                f"firmware, {words}, two threads",
                two_threads(fast[name], two[name]),
                "1.7 times one thread",
            )
        )
    for count, case in sized.items():
        share = case.cost_s / count / one
        found.append((f"firmware, cost of a tile in a block of {count}", f"{share:.2f} of a lone one's", ""))
    return found


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))
