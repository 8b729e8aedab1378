"""One client's run: a thread that owns a source, obeys commands, and passes on what happens.

A source is what stands behind the page: anything that tells of tiles in the stream's events.
"""

import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from tilenca.base.errors import TilencaError
from tilenca.protocol.stream import StreamEvent, refused_event
from tilenca.protocol.stream_commands import StreamCommand

TICK_S = 1 / 60
# How long an idle run waits for a command before it looks whether it is to end.
IDLE_S = 0.25
# A run that was held up does not catch up with more than this.
MOST_TICK_S = 0.1
MOST_COMMANDS = 256
MOST_REFUSAL = 300  # characters


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
        """

    @property
    def is_idle(self) -> bool:
        """Whether nothing happens until the next command."""

    def close(self) -> None:
        """Frees what it holds."""


class Session:
    """Runs a source until it is closed."""

    def __init__(
        self, make_source: Callable[[], Source], deliver: Callable[[list[StreamEvent]], None]
    ) -> None:
        """Starts the thread.

        Args:
            make_source: called in the thread.
            deliver: takes events, in the thread.
        """
        self._make_source, self._deliver = make_source, deliver
        self._commands: queue.Queue[StreamCommand | None] = queue.Queue(MOST_COMMANDS)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="tilenca-page-run", daemon=True)
        self._thread.start()

    def offer(self, command: StreamCommand) -> bool:
        """Hands a command over; False: too many wait."""
        try:
            self._commands.put_nowait(command)
        except queue.Full:
            return False
        return True

    def close(self, wait_s: float = 2.0) -> None:
        """Ends the run."""
        self._ended.set()
        with suppress(queue.Full):
            self._commands.put_nowait(None)  # so that an idle one looks up
        self._thread.join(wait_s)

    def _run(self) -> None:
        try:
            source = self._make_source()
        except TilencaError as error:
            self._deliver([_refusal(error)])
            return
        try:
            self._deliver(source.begin())
            before_s = time.monotonic()
            while not self._ended.is_set():
                self._obey(source, IDLE_S if source.is_idle else before_s + TICK_S - time.monotonic())
                now_s = time.monotonic()
                try:
                    events = source.advance(min(now_s - before_s, MOST_TICK_S))
                except TilencaError as error:
                    events = [_refusal(error)]
                before_s = now_s
                if events:
                    self._deliver(events)
        finally:
            source.close()

    def _obey(self, source: Source, wait_s: float) -> None:
        """Takes the commands that have come; waits for the first one."""
        while True:
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
                source.take(command)
            except TilencaError as error:
                self._deliver([_refusal(error)])


def _refusal(error: TilencaError) -> StreamEvent:
    return refused_event(0.0, str(error)[:MOST_REFUSAL])
