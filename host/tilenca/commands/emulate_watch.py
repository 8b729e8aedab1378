"""`tilenca emulate --watch`: the tiles on a terminal while they run, with keys; elsewhere their changes."""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from tilenca.commands.emulate_runs import EmulationResult, LayOut, keep, observe, result_of
from tilenca.emulator.experiment import SLICE_S, Emulation
from tilenca.fleet.recording import Recorder
from tilenca.protocol.line_reader import Heard
from tilenca.shapes.file import Shape, Task
from tilenca.views.emulated import counted, take_picture
from tilenca.views.keyboard import Keyboard, our_terminal
from tilenca.views.tiles import fitting

SETTLING_S = 0.001
SPEEDS = (1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4)
USUAL = SPEEDS.index(1)
LEAST_S = 1e-6  # a step that is nearer to its end is done
MOST_DIGITS = 3  # of a tile's number
PAUSED_S = 0.1  # between looks at the keyboard while nothing runs
SMOOTH_S = 0.05  # of the wall clock between two pictures, at most
STEP_S = 0.02  # as long as an update where the firmware does not say
KEYS = "space pause  . step  + - speed  p pull (7p: tile 7)  b put back  n next  q quit"

Wait = Callable[[float], Sequence[str]]


@dataclass
class Hands:
    """What the keys have asked for; owns no clock.

    Attributes:
        emulation: the tiles.
        period_s: emulated time of a step.
        speed: index of SPEEDS.
        paused: whether time stands still.
        step_to_s: the emulated time until which a step runs; None: none does.
        out: the tiles that were pulled, the last one last.
        ended: `next` or `quit`, once asked for.
        number: the digits typed so far, for the tile that `p` pulls.
        said: an answer to the last key, if there is one.
        pulled: all tiles that were pulled, back by now or not.
        updates: the most that all tiles had done: one that is put back begins anew, or where it was.
    """

    emulation: Emulation
    period_s: float
    speed: int = USUAL
    paused: bool = False
    step_to_s: float | None = None
    out: list[int] = field(default_factory=list)
    ended: str | None = None
    number: str = ""
    said: str = ""
    pulled: list[int] = field(default_factory=list)
    updates: int = 0

    def obey(self, key: str) -> None:
        """Does what a key says; any other key is answered."""
        self.said, number = "", self.number
        self.number = (number + key)[-MOST_DIGITS:] if key.isdecimal() and key.isascii() else ""
        if self.number:
            self.said = f"tile {self.number}: p pulls it"
        elif key == " ":
            self.paused, self.step_to_s = not self.paused, None
        elif key == ".":
            self.paused, self.step_to_s = True, self.emulation.array.time_s + self.period_s
        elif key in "+-":
            self.speed = min(max(self.speed + (1 if key == "+" else -1), 0), len(SPEEDS) - 1)
        elif key == "p":
            self._pull(number)
        elif key == "b":
            while self.out:
                self.emulation.faults.plug(self.out.pop(), True)
        elif key in "nq":
            self.ended = "next" if key == "n" else "quit"
        elif key.isprintable():
            self.said = f"no key {key}; the keys are below"

    def _pull(self, number: str) -> None:
        """Pulls the tile of that number, or without one the next, far from the one before; one tile stays."""
        standing = [tile.index for tile in self.emulation.array if tile.powered]
        tile = (
            int(number) - 1 if number else standing[(len(standing) // 2 + 3 * len(self.out)) % len(standing)]
        )
        if tile not in standing:
            self.said = f"no tile {number} with power to pull"
        elif len(standing) == 1:
            self.said = "the last tile stays"
        else:
            self.emulation.faults.plug(tile, False)
            self.out.append(tile)
            self.pulled.append(tile)
            self.said = f"pulled tile {tile + 1}"

    @property
    def stands(self) -> bool:
        """Whether time stands still now."""
        if self.step_to_s is not None and self.emulation.array.time_s > self.step_to_s - LEAST_S:
            self.step_to_s = None
        return self.paused and self.step_to_s is None

    def caption(self) -> list[str]:
        """What the tiles show; the time, the least advanced tile's updates, and what was asked."""
        running = self.emulation
        self.updates = max(self.updates, running.fewest_updates())
        parts = [f"{running.array.time_s:.2f} s", f"update {self.updates}"]
        if self.speed != USUAL:
            speed = SPEEDS[self.speed]
            parts.append(f"{speed:g} times real time" if speed > 1 else f"1/{1 / speed:.0f} of real time")
        if self.paused:
            parts.append("paused")
        if self.out:
            tiles = ", ".join(str(tile + 1) for tile in self.out)
            parts.append(f"pulled: tile{'s' * (len(self.out) > 1)} {tiles}")
        elif self.ended is not None and self.pulled:
            parts.append(
                f"pulled and put back: {', '.join(str(tile + 1) for tile in dict.fromkeys(self.pulled))}"
            )
        if self.said and not self.said.startswith("pulled"):
            parts.append(self.said)
        return [f"{running.shape.name}: {counted(running)}", "   ".join(parts)]

    def slice_s(self) -> float:
        """The emulated time to run next: not beyond a step, and short where time is slow."""
        if self.stands:
            return 0.0
        run_s = min(SLICE_S, SMOOTH_S * SPEEDS[self.speed])
        return run_s if self.step_to_s is None else min(run_s, self.step_to_s - self.emulation.array.time_s)


def watch_all(
    args: argparse.Namespace, task: Task, lay_out: LayOut, shapes: Sequence[Shape], record: Recorder | None
) -> list[EmulationResult]:
    """Runs shapes one after the other in step with the wall clock, and shows them.

    On a terminal with a keyboard a shape runs until a key ends it, or as long as the arguments say; else
    until its tiles agree, as without `--watch`.
    """
    console = Console()
    results = []
    with ExitStack() as stack:
        wait: Wait | None = None
        if console.is_terminal and (keys := our_terminal()) is not None:
            wait = stack.enter_context(Keyboard(keys, sys.stdout.fileno())).wait
        for shape in shapes:
            started, emulation = time.monotonic(), lay_out(shape)
            with emulation.array, observe(emulation, args) as on_slice:

                def heed(
                    heard: list[Heard], shape: Shape = shape, on_slice: Callable[[], None] = on_slice
                ) -> None:
                    on_slice()
                    keep(record, shape, heard)

                if console.is_terminal:
                    endless = wait is not None and args.seconds is None and args.updates is None
                    ended = _show(emulation, console, wait, endless, heed)
                else:
                    ended = None
                    _tell(emulation, heed)
                results.append(result_of(args, emulation, task, started))
            if ended == "quit":
                break
    return results


def _show(
    emulation: Emulation,
    console: Console,
    wait: Wait | None,
    endless: bool,
    heed: Callable[[list[Heard]], None],
) -> str | None:
    """Runs a shape on the terminal; how a key ended it, None: by itself."""
    hands = Hands(emulation, (emulation.period_ms or STEP_S * 1000) / 1000)
    keys = [KEYS] if wait is not None else []

    def picture() -> Group:
        caption = [*(Text(line, "bold") for line in hands.caption()), *(Text(line, "dim") for line in keys)]
        room = console.height - len(caption) - 1
        ascii_only = console.options.ascii_only
        tiles = fitting(take_picture(emulation), console.width, room, ascii_only, emulation.labels)
        for line in caption:
            line.truncate(console.width)
        return Group(*tiles, *caption)

    with Live(console=console, auto_refresh=False) as live:
        while hands.ended is None and (endless or not emulation.done()):
            began_s, speed = time.monotonic(), SPEEDS[hands.speed]
            run_s = hands.slice_s()
            if run_s:
                heed(emulation.advance(run_s))
            live.update(picture(), refresh=True)
            left_s = PAUSED_S if not run_s else max(0.0, began_s + run_s / speed - time.monotonic())
            if wait is None:
                time.sleep(left_s)
                continue
            for key in wait(left_s):
                hands.obey(key)
        live.update(picture(), refresh=True)
    return hands.ended


def _tell(emulation: Emulation, heed: Callable[[list[Heard]], None]) -> None:
    """Runs a shape, and prints a line for every change of a display."""
    told = [0] * len(emulation.array)

    def tell(running: Emulation, heard: list[Heard]) -> None:
        heed(heard)
        _tell_changes(running, told)

    emulation.run(tell)


def _tell_changes(emulation: Emulation, told: list[int]) -> None:
    """One plain line for every change of a display, for what is not a terminal."""
    news = []
    for tile in emulation.array:
        changes = tile.display_changes[told[tile.index] :]
        told[tile.index] += len(changes)
        # A tile sets its segments one by one: of what it shows within a millisecond only the last counts.
        for following, change in enumerate(changes, start=1):
            if following == len(changes) or changes[following].time_s - change.time_s > SETTLING_S:
                news.append((change.time_s, tile.index, change.segments))
    for time_s, index, segments in sorted(news):
        shown = emulation.label(segments) or "nothing"
        print(f"{time_s:8.3f} s  {emulation.shape.name}: tile {index + 1} shows {shown}")
