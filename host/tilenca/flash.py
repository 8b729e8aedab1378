"""`tilenca flash`: one firmware image into many boards, side by side."""

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars

from tilenca import paths
from tilenca.arguments import add_port_argument, count, positive
from tilenca.avrdude import Progress, find_avrdude
from tilenca.errors import BuildError
from tilenca.ihex import check_image
from tilenca.ports import find_ports
from tilenca.programming import Outcome, program_all
from tilenca.streams import warn
from tilenca.tables import table

FIRMWARE_HEX = paths.FIRMWARE_ELF.with_suffix(".hex")

# Three of avrdude's attempts to get an answer, which are 5 s apart.
TIMEOUT_S = 12.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_port_argument(parser)
    parser.add_argument("--jobs", type=count, metavar="N", help="boards at a time (default: all)")
    parser.add_argument("--hex", type=Path, metavar="F", help="write this Intel HEX image; nothing is built")
    parser.add_argument("--no-build", action="store_true", help="write the image that is there")
    parser.add_argument(
        "--timeout",
        type=positive,
        default=TIMEOUT_S,
        metavar="S",
        help="give a board up after S seconds without progress (default: %(default)g)",
    )
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


def run(args: argparse.Namespace) -> int:
    """Finds the boards, builds, checks the image, programs all of them; see `tilenca flash --help`."""
    names = [port.name for port in find_ports(args.port)]
    tool = find_avrdude()
    image = args.hex or FIRMWARE_HEX
    if not (args.hex or args.no_build):
        build()
    size = check_image(image)
    warn(f"writing {image} ({size} bytes) to {len(names)} board{'s' * (len(names) != 1)} with {tool.program}")
    with _display(names) as display:
        outcomes = program_all(tool, image, names, args.jobs or len(names), args.timeout, display.show)
    if args.json:
        print(json.dumps({"tiles": [asdict(outcome) for outcome in outcomes]}, indent=2))
    else:
        rows = [[o.port, o.result, f"{o.seconds:.1f}", o.error or ""] for o in outcomes]
        print(table(["PORT", "RESULT", "SECONDS", "WHY"], rows))
    results = [outcome.result for outcome in outcomes]
    if "interrupted" in results:
        raise KeyboardInterrupt
    warn(f"{results.count('flashed')} of {len(results)} flashed")
    return 0 if set(results) == {"flashed"} else 1


def build() -> None:
    """Builds the firmware; PlatformIO itself knows what is up to date. Its output is shown only if it fails.

    Raises:
        BuildError: PlatformIO is missing or the build failed.
    """
    beside = Path(sys.executable).with_name("pio")
    pio = str(beside) if beside.exists() else shutil.which("pio")
    if pio is None:
        raise BuildError("PlatformIO is not installed; run `make setup`, or name an image with --hex")
    warn("building the firmware")
    command = [pio, "run", "-e", paths.FIRMWARE_ENV]
    # A process group of its own: what the build started ends with it.
    with subprocess.Popen(
        command,
        cwd=paths.ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        process_group=0,
    ) as building:
        try:
            output, _ = building.communicate()
        except BaseException:
            with suppress(ProcessLookupError):
                os.killpg(building.pid, signal.SIGKILL)
            raise
    if building.returncode != 0:
        warn(output.decode("utf-8", "replace").rstrip("\n"))
        raise BuildError(
            f"`{' '.join(command)}` failed with status {building.returncode}; its output is above"
        )


class _Lines:
    """Progress as plain lines: one for every change of a board's phase."""

    def __init__(self) -> None:
        self._said: dict[str, str] = {}

    def show(self, name: str, news: Progress | Outcome) -> None:
        """Says what is new."""
        text = _summary(news) if isinstance(news, Outcome) else news.phase
        if self._said.get(name) != text:
            self._said[name] = text
            warn(f"{name}: {text}")


# Where on the bar each phase starts, and how much of it the phase takes.
SPANS = {"connecting": (0.0, 0.0), "writing": (0.0, 0.5), "verifying": (0.5, 0.5)}


class _Bars:
    """Progress as one bar per board."""

    def __init__(self, bars: Bars, names: Sequence[str]) -> None:
        self._bars = bars
        self._tasks = {
            name: bars.add_task(escape(name), total=1.0, start=False, phase="waiting") for name in names
        }

    def show(self, name: str, news: Progress | Outcome) -> None:
        """Moves the board's bar."""
        task = self._tasks[name]
        if isinstance(news, Outcome):
            completed = 1.0 if news.result == "flashed" else None
            self._bars.update(task, phase=news.result, completed=completed)
            self._bars.stop_task(task)
            return
        start, width = SPANS[news.phase]
        if news.phase == "connecting":
            self._bars.start_task(task)
        self._bars.update(task, phase=news.phase, completed=start + width * news.share)


def _summary(outcome: Outcome) -> str:
    return outcome.result if outcome.error is None else f"{outcome.result}: {outcome.error}"


@contextmanager
def _display(names: Sequence[str]) -> Iterator[_Lines | _Bars]:
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield _Lines()
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[phase]}"),
    )
    with Bars(*columns, console=console) as bars:
        yield _Bars(bars, names)
