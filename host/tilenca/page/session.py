"""One client's run: a thread that owns a source, obeys commands, and passes on what happens.

A source is what stands behind the page: anything that tells of tiles in the stream's events.
"""

import math
import queue
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from tilenca.base.errors import TilencaError
from tilenca.protocol.stream import StreamEvent, refused_event
from tilenca.protocol.stream_commands import Step, StreamCommand

TICK_S = 1 / 60
# How long an idle run waits for a command before it looks whether it is to end.
IDLE_S = 0.25
# A run that was held up does not catch up with more than this.
MOST_TICK_S = 0.1
MOST_COMMANDS = 256
# Emulated; a longer step is made of several, so that a run can end in between.
STEP_SLICE_S = 0.05
LEAST_STEP_S = 1e-6  # less is a rounding error


class EndedError(TilencaError):
    """A source is over for good; no command can let it go on."""


class Source(Protocol):
    """Tiles that run, or ran. One thread uses it."""

    def begin(self) -> list[StreamEvent]:
        """The first events: what it is, and what it can do."""

    def take(self, command: StreamCommand) -> None:
        """Carries out a command.

        Raises:
            TilencaError: it cannot; the message is for the person at the page.
        """

    def advance(self, wall_s: float) -> list[StreamEvent]:
        """Goes on for so much time of the wall clock; returns what has happened.

        Raises:
            TilencaError: it cannot go on; the next command may let it.
            EndedError: nothing can, and the run ends.
        """

    @property
    def is_idle(self) -> bool:
        """Whether nothing happens until the next command."""

    def abandon(self) -> None:
        """Called in another thread, once: `advance` ends soon, also where something takes long."""

    def close(self) -> None:
        """Frees what it holds."""


class Session:
    """Runs a source until it is closed."""

    def __init__(
        self,
        make_source: Callable[[], Source],
        deliver: Callable[[list[StreamEvent]], None],
        tell_end: Callable[[], None] = lambda: None,
    ) -> None:
        """Starts the thread.

        Args:
            make_source: called in the thread.
            deliver: takes events, in the thread.
            tell_end: called in the thread, last of all: no event comes after it.
        """
        self._make_source, self._deliver, self._tell_end = make_source, deliver, tell_end
        self._commands: queue.Queue[StreamCommand | None] = queue.Queue(MOST_COMMANDS)
        self._ended = threading.Event()
        self._source: Source | None = None
        self._thread = threading.Thread(target=self._run, name="tilenca-page-run", daemon=True)
        self._thread.start()

    def offer(self, command: StreamCommand) -> bool:
        """Hands a command over; False: too many wait."""
        try:
            self._commands.put_nowait(command)
        except queue.Full:
            return False
        return True

    def close(self) -> None:
        """Ends the run, and waits for its thread; commands that it has not begun are dropped."""
        self._ended.set()
        if self._source is not None:  # else it is not made yet, and will not advance
            self._source.abandon()
        with suppress(queue.Full):
            self._commands.put_nowait(None)  # so that an idle one looks up
        self._thread.join()

    def _run(self) -> None:
        try:
            self._serve()
        except TilencaError as error:
            self._deliver([_refusal(error)])
        except Exception as error:  # a mistake of ours: the person at the page must not wait for ever
            traceback.print_exc()
            self._deliver([_refusal(error, f"the run broke off: {type(error).__name__}: ")])
        finally:
            self._tell_end()

    def _serve(self) -> None:
        source = self._source = self._make_source()
        try:
            self._deliver(source.begin())
            before_s = time.monotonic()
            while not self._ended.is_set():
                self._obey(source, IDLE_S if source.is_idle else before_s + TICK_S - time.monotonic())
                if self._ended.is_set():
                    return
                now_s = time.monotonic()
                try:
                    events = source.advance(min(now_s - before_s, MOST_TICK_S))
                except EndedError:
                    raise
                except TilencaError as error:
                    events = [_refusal(error)]
                before_s = now_s
                if events:
                    self._deliver(events)
        finally:
            source.close()

    def _obey(self, source: Source, wait_s: float) -> None:
        """Takes the commands that have come; waits for the first one."""
        while not self._ended.is_set():
            try:
                command = (
                    self._commands.get(timeout=max(wait_s, 0.0))
                    if wait_s > 0
                    else self._commands.get_nowait()
                )
            except queue.Empty:
                return
            wait_s = 0.0
            if command is None:
                return
            try:
                self._take(source, command)
            except EndedError:
                raise
            except TilencaError as error:
                self._deliver([_refusal(error)])

    def _take(self, source: Source, command: StreamCommand) -> None:
        if not isinstance(command, Step):
            source.take(command)
            return
        whole = math.floor(command.seconds / STEP_SLICE_S * (1 + 1e-9))
        rest_s = command.seconds - whole * STEP_SLICE_S
        slices = [STEP_SLICE_S] * whole + ([rest_s] if rest_s > LEAST_STEP_S or not whole else [])
        for seconds in slices:
            if self._ended.is_set():
                return
            source.take(Step(seconds))


def _refusal(error: Exception, before: str = "") -> StreamEvent:
    return refused_event(0.0, f"{before}{error}")
