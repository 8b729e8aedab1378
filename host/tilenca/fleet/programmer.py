"""Programming many boards side by side, each by an avrdude of its own.

A run is a child process whose standard error is read as it comes. `program_all` keeps several going from one
thread, so that an interrupt ends all of them and leaves none behind.
"""

import os
import selectors
import subprocess
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from tilenca.base.signals import held_back
from tilenca.fleet.avrdude import GONE, NO_REPLY, Avrdude, Output, Progress
from tilenca.fleet.lock import PortBusyError, holders, port_lock
from tilenca.fleet.ports import denial, is_device

# The time between two looks at a silent board: avrdude takes long to notice that it is gone.
LOOK_AROUND_S = 0.5

# Opening the port again resets the board again. That helps where avrdude came too late for the bootloader,
# which listens only for a second or two; where the bootloader hangs; where a byte was damaged on the way; and
# where the cable was loose for a moment. A wrong chip stays one.
ATTEMPTS = 2
PHASES = ("connecting", "writing", "verifying")


@dataclass(frozen=True)
class ProgramResult:
    """The outcome of one board.

    Attributes:
        port: its port.
        result: `flashed`, `failed` or `interrupted`.
        seconds: from the start of the first attempt to the end of the last.
        error: the fault and the remedy; None if flashed.
        attempts: their number.
        phase: the last one that the last attempt reached.
        passing: whether another attempt could succeed.
    """

    port: str
    result: str
    seconds: float
    error: str | None = None
    attempts: int = 0
    phase: str = "connecting"
    passing: bool = False


class Run:
    """One avrdude that works on one port."""

    def __init__(self, tool: Avrdude, image: Path, port: str, lock: int) -> None:
        """Starts it; it holds `lock` as long as it lives, even after this process."""
        self.port = port
        self.output = Output()
        self.started_s = self.moved_s = time.monotonic()
        self._failure: str | None = None
        self._process = subprocess.Popen(
            tool.command(port, image),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            pass_fds=(lock,),
            env={**os.environ, "LC_ALL": "C"},
        )
        assert self._process.stderr is not None
        self.stream = self._process.stderr

    def read(self) -> bool:
        """Reads the available output; False at its end."""
        data = os.read(self.stream.fileno(), 4096)
        before = self.output.progress
        self.output.feed(data)
        if self.output.progress != before:
            self.moved_s = time.monotonic()
        if self.output.hopeless:
            self.kill(self.output.reason(self.port))
        return bool(data)

    def kill(self, reason: str) -> None:
        """Ends it at once; the reason becomes the board's error."""
        if self._failure is None:
            self._failure = reason
        self._process.kill()

    def give_up(self) -> None:
        """Ends it because the board is silent."""
        phase = self.output.progress.phase
        if not is_device(self.port):
            self.kill(GONE)
            return
        self.kill(
            NO_REPLY if phase == "connecting" else f"silent while {phase}; reconnect it and flash it again"
        )

    def finish(self) -> ProgramResult:
        """Waits for the end of the process; returns the board's outcome."""
        status = self._process.wait()
        self.stream.close()
        seconds = round(time.monotonic() - self.started_s, 2)
        phase = self.output.progress.phase
        if self._failure is None and status == 0:
            return ProgramResult(self.port, "flashed", seconds, phase=phase)
        reason = self._failure or self.output.reason(self.port)
        return ProgramResult(self.port, "failed", seconds, reason, 0, phase, self.output.passing)


def program_all(
    tool: Avrdude,
    image: Path,
    names: Sequence[str],
    jobs: int,
    timeout_s: float,
    report: Callable[[str, Progress | ProgramResult], None],
) -> list[ProgramResult]:
    """Programs the boards at `names`, at most `jobs` at a time; one that fails does not stop the others.

    Args:
        tool: avrdude.
        image: a checked Intel HEX file.
        names: the ports, each another board.
        jobs: how many at a time.
        timeout_s: the longest time without progress before a board is given up.
        report: called with a port and its progress, and once with its outcome.

    Returns:
        One outcome per port, in the order of `names`; on an interrupt, `interrupted` for those not done.
    """
    fleet = _Fleet(tool, image, timeout_s, report)
    waiting = deque(names)
    try:
        while waiting or fleet.runs:
            while waiting and len(fleet.runs) < jobs:
                fleet.start(waiting.popleft())
            fleet.step()
    except KeyboardInterrupt:
        begun = {outcome.port: outcome for outcome in fleet.stop()}
        for name in fleet.pending(names):
            before = begun.get(name, ProgramResult(name, "failed", 0.0))
            fleet.outcomes[name] = replace(before, result="interrupted", error="interrupted; flash it again")
    finally:
        fleet.stop()
    return [fleet.outcomes[name] for name in names]


class _Fleet:
    """The current runs, and the outcomes so far."""

    def __init__(
        self,
        tool: Avrdude,
        image: Path,
        timeout_s: float,
        report: Callable[[str, Progress | ProgramResult], None],
    ) -> None:
        self.outcomes: dict[str, ProgramResult] = {}
        self.runs: dict[str, tuple[Run, ExitStack]] = {}
        self._tool, self._image, self._timeout_s, self._report = tool, image, timeout_s, report
        self._selector = selectors.DefaultSelector()
        self._attempts: Counter[str] = Counter()
        self._before: dict[str, ProgramResult] = {}

    def start(self, name: str) -> None:
        """Starts on a board, unless it would certainly fail."""
        lock = ExitStack()
        try:
            descriptor = lock.enter_context(port_lock(name, "tilenca flash"))
        except PortBusyError as busy:
            self._done(
                ProgramResult(name, "failed", 0.0, f"busy: {busy} has it open; close that, then flash again")
            )
            return
        if problem := _obstacle(name):
            lock.close()
            self._done(ProgramResult(name, "failed", 0.0, problem))
            return
        self._attempts[name] += 1
        with held_back():
            run = Run(self._tool, self._image, name, descriptor)
            self.runs[name] = run, lock
        self._selector.register(run.stream, selectors.EVENT_READ, run)
        self._tell(run)

    def _tell(self, run: Run) -> None:
        progress = run.output.progress
        if progress.phase == "connecting" and self._attempts[run.port] > 1:
            progress = replace(progress, phase="trying again")
        self._report(run.port, progress)

    def step(self) -> None:
        """Waits for news of any board, or for the next one to run out of time."""
        if not self.runs:
            return
        now_s = time.monotonic()
        next_s = min(run.moved_s for run, _ in self.runs.values()) + self._timeout_s
        for key, _ in self._selector.select(min(max(next_s - now_s, 0.0), LOOK_AROUND_S)):
            self._advance(key.data)
        for run, _ in self.runs.values():
            if time.monotonic() - run.moved_s >= self._timeout_s or not is_device(run.port):
                run.give_up()

    def _advance(self, run: Run) -> None:
        if run.read():
            self._tell(run)
            return
        self._selector.unregister(run.stream)
        outcome = run.finish()
        self.runs.pop(run.port)[1].close()
        if before := self._before.get(run.port):
            outcome = _both(before, outcome)
        attempts = self._attempts[run.port]
        if outcome.result == "failed" and outcome.passing and attempts < ATTEMPTS and is_device(run.port):
            self._before[run.port] = outcome
            self.start(run.port)
        else:
            self._done(replace(outcome, attempts=attempts))

    def pending(self, names: Iterable[str]) -> list[str]:
        """The boards without an outcome, after an interrupt."""
        return [name for name in names if name not in self.outcomes]

    def _done(self, outcome: ProgramResult) -> None:
        self.outcomes[outcome.port] = outcome
        self._report(outcome.port, outcome)

    def stop(self) -> list[ProgramResult]:
        """Ends all current runs; returns their outcomes."""
        stopped = []
        for run, lock in self.runs.values():
            run.kill("interrupted")
            outcome = run.finish()
            if before := self._before.get(run.port):
                outcome = _both(before, outcome)
            stopped.append(replace(outcome, attempts=self._attempts[run.port]))
            lock.close()
        self.runs.clear()
        return stopped


def _both(first: ProgramResult, second: ProgramResult) -> ProgramResult:
    """The outcome of two attempts: if both failed, the one that came further gives the reason."""
    seconds = round(first.seconds + second.seconds, 2)
    further = PHASES.index(first.phase) > PHASES.index(second.phase)
    return replace(first if further and second.result == "failed" else second, seconds=seconds)


def _obstacle(name: str) -> str | None:
    """A reason why avrdude would fail on this port, or never end; None if there is none."""
    if not is_device(name):
        return "not a serial port" if Path(name).exists() else "no such port; is the board connected?"
    if denied := denial(name):
        return denied
    if holder := holders([name]).get(name):
        return f"busy: {holder} has it open; close that, then flash again"
    return None
