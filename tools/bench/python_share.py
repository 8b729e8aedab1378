"""What Python takes of the processor time of `tilenca emulate`: python -m bench.python_share [--seconds N].

The time outside of `Array.run`, which is one call of the compiled emulator. Two runs, one five times as long
as the other, tell what each emulated second takes, and what the command takes once, for its start and end.
"""

import argparse
import contextlib
import io
import subprocess
import sys
import time
from dataclasses import dataclass
from statistics import median

from bench.figures import note, of_rounds
from tilenca import cli
from tilenca.commands.arguments import whole
from tilenca.emulator import Array

SHORT_S, LONGER = 12, 5
SHAPE = "8"


@dataclass(frozen=True)
class Spent:
    """Processor seconds of a whole process, and of them those in the emulator's library."""

    total_s: float
    library_s: float

    @property
    def python_s(self) -> float:
        """The rest."""
        return self.total_s - self.library_s


def spent_here(seconds: float) -> Spent:
    """Runs the command in this process, so long in emulated time."""
    library_s, run = 0.0, Array.run

    def timed(array: Array, emulated_s: float) -> None:
        nonlocal library_s
        before_s = time.process_time()
        run(array, emulated_s)
        library_s += time.process_time() - before_s

    Array.run = timed  # type: ignore[assignment]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        status = cli.main(["emulate", "--shape", SHAPE, "--threads", "1", "--seconds", f"{seconds:g}"])
    if status != 0:
        raise RuntimeError(f"the command ended with {status}")
    return Spent(time.process_time(), library_s)


def spent(seconds: float) -> Spent:
    """The same in a process of its own."""
    words = [sys.executable, "-m", "bench.python_share", "--seconds", f"{seconds:g}"]
    done = subprocess.run(words, capture_output=True, check=True, text=True)
    total_s, library_s = map(float, done.stdout.split())
    return Spent(total_s, library_s)


def measure(rounds: int) -> list[tuple[str, str, str]]:
    """Name, figure and target; one row per figure."""
    shares, once_s = [], []
    for _ in range(rounds):
        short, long = spent(SHORT_S), spent(SHORT_S * LONGER)
        further_s = long.python_s - short.python_s
        shares.append(further_s / (long.total_s - short.total_s))
        once_s.append(short.python_s - further_s / (LONGER - 1))
    if rounds > 1:
        note(of_rounds("emulator: Python's share of each emulated second", shares, "of the time", False))
    what = f"`tilenca emulate --shape {SHAPE}`, sixteen tiles, one thread: Python, of each emulated second"
    return [
        (what, f"{100 * median(shares):.1f} %", "3 %"),
        ("the same, Python once for the command's start and end", f"{min(once_s):.1f} s", ""),
    ]


def main() -> int:
    """Prints the processor seconds of one run, all and those in the library."""
    parser = argparse.ArgumentParser(description="What Python takes of an emulation.")
    parser.add_argument(
        "--seconds", type=whole(1), default=SHORT_S * LONGER, help="emulated (default: %(default)s)"
    )
    one = spent_here(parser.parse_args().seconds)
    print(f"{one.total_s:.3f} {one.library_s:.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
