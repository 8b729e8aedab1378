"""The emulator's speed, as ratios measured in one run: python -m bench.emulator [--write FILE].

The real firmware comes first (`bench.emulator_firmware`), then programs that never sleep or always do.

Wall times vary with the machine and its load; so each figure is the best of a few rounds, and the compared
programs take turns.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from bench import emulator_firmware, python_share
from bench.publish import publish
from bench.reference import COMMIT
from tilenca.base.paths import FIRMWARE_ELF, ROOT
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array, Link

SOURCES = ROOT / "tools" / "emulator" / "bench"
BEGIN, END = "<!-- emulator: made by `make bench`, do not edit -->", "<!-- /emulator -->"
CLOCK_MHZ = 16
WARM_UP_S = 0.02
TILES = 20
COUNTS = (1, 2, 5, 10, 20, 50, 100)
MEGACYCLES = 24


def compiled(name: str, directory: Path) -> Path:
    """A program for the tile, compiled; its ELF file."""
    elf = directory / f"{name}.elf"
    command = ["avr-gcc", "-mmcu=atmega2560", "-DF_CPU=16000000UL", "-Os"]
    subprocess.run([*command, str(SOURCES / f"{name}.c"), "-o", str(elf)], check=True)
    return elf


def simavr(directory: Path) -> Path | None:
    """The program that runs libsimavr; None where that is not installed."""
    program = directory / "simavr"
    command = ["gcc", "-O2", str(SOURCES / "simavr.c"), "-o", str(program), "-lsimavr", "-lelf"]
    done = subprocess.run(command, capture_output=True, check=False)
    return program if done.returncode == 0 else None


def simavr_mhz(program: Path, elf: Path) -> float:
    """Millions of cycles a second of libsimavr."""
    command = [str(program), str(elf), str(MEGACYCLES)]
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    return float(done.stderr)


def times_real_time(
    elf: Path, tiles: int, seconds: float, threads: int = 1, links: Sequence[Link] = ()
) -> float:
    """Emulated seconds in a second."""
    with Array(elf, tiles, links, threads=threads) as array:
        array.run(WARM_UP_S)
        started = time.perf_counter()
        array.run(seconds)
        return seconds / (time.perf_counter() - started)


def set_up_ms(elf: Path, tiles: int) -> float:
    """Milliseconds from an ELF file to an array that can run."""
    started = time.perf_counter()
    with Array(elf, tiles):
        return 1000 * (time.perf_counter() - started)


def best(figures: Sequence[float]) -> float:
    """The greatest, since other load can only slow it down."""
    return max(figures)


def measure(rounds: int, directory: Path) -> list[tuple[str, str, str]]:
    """Name, figure and target; one row per figure."""
    busy, idle = compiled("busy", directory), compiled("idle", directory)
    theirs = simavr(directory)
    ours_mhz, their_mhz = [], []
    busy_one, busy_two, sleeping, crowd, set_up = [], [], [], [], []
    joined: dict[int, list[float]] = {1: [], 2: []}
    row = [(tile, EAST, tile + 1, WEST) for tile in range(TILES - 1)]
    cost: dict[int, list[float]] = {count: [] for count in COUNTS}
    for _ in range(rounds):
        ours_mhz.append(CLOCK_MHZ * times_real_time(busy, 1, MEGACYCLES / CLOCK_MHZ))
        if theirs is not None:
            their_mhz.append(simavr_mhz(theirs, busy))
        busy_one.append(times_real_time(busy, TILES, 0.2))
        busy_two.append(times_real_time(busy, TILES, 0.2, threads=2))
        for threads, figures in joined.items():
            figures.append(times_real_time(busy, TILES, 0.2, threads, row))
        sleeping.append(times_real_time(idle, TILES, 1.0))
        crowd.append(times_real_time(busy, 100, 0.04))
        set_up.append(-set_up_ms(busy, TILES))
        for count in COUNTS:
            cost[count].append(count * times_real_time(busy, count, 2.0 / count))
    if their_mhz:
        emulator_firmware.note_ratios("one busy tile, against libsimavr", ours_mhz, their_mhz)
    one = best(cost[1])
    ratio = (
        f"{best(ours_mhz) / best(their_mhz):.1f} times libsimavr"
        if their_mhz
        else "libsimavr is not installed"
    )
    rows = [
        ("one busy tile, one core", f"{best(ours_mhz):.0f} MHz, {ratio}", "600 MHz, 6 times"),
        (f"{TILES} busy tiles, one thread", f"{best(busy_one):.1f} times real time", "2.5"),
        (f"{TILES} busy tiles, two threads", f"{best(busy_two):.1f} times real time", "4.5"),
        (
            f"{TILES} busy tiles in a row, cables between them, one thread and two",
            f"{best(joined[1]):.1f} and {best(joined[2]):.1f} times real time",
            "",
        ),
        (f"{TILES} sleeping tiles, one thread", f"{best(sleeping):.0f} times real time", "50"),
        ("100 busy tiles, one thread", f"{best(crowd):.2f} times real time", "they run"),
        (f"set-up of {TILES} tiles", f"{-best(set_up):.1f} ms", "50 ms"),
    ]
    for count in COUNTS[1:]:
        rows.append(
            (f"cost of a busy tile among {count}", f"{one / best(cost[count]):.2f} of a lone one's", "")
        )
    return rows


def table(rows: Sequence[tuple[str, str, str]]) -> str:
    """The rows in Markdown."""
    lines = ["| emulator | measured | target |", "|---|---|---|"]
    return "\n".join([*lines, *(f"| {what} | {figure} | {target} |" for what, figure, target in rows)])


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="How fast the emulator is.")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    parser.add_argument(
        "--rounds", type=int, default=3, help="take the best of so many (default: %(default)s)"
    )
    args = parser.parse_args()
    if shutil.which("avr-gcc") is None:
        print("bench: avr-gcc is not installed; the emulator is not measured", file=sys.stderr)
        return 0
    with tempfile.TemporaryDirectory() as directory:
        place = Path(directory)
        firmware = emulator_firmware.measure(args.rounds, FIRMWARE_ELF, simavr(place))
        section = table([*firmware, *python_share.measure(args.rounds), *measure(args.rounds, place)])
    cores = emulator_firmware.cores()
    section += f"\n\nBest of {args.rounds} rounds, on {cores} cores; the processor times at {COMMIT} and "
    section += "Python's share are medians. Other programs may have run meanwhile."
    publish(section, args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
