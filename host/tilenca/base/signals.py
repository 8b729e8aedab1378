"""One policy for all polite ways to end a command: each acts like Ctrl-C and is acknowledged in a second."""

import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from types import FrameType

from tilenca.base.stdio import warn

SIGNALS = (signal.SIGTERM, signal.SIGHUP)
NAMES = {signal.SIGINT: "Ctrl-C", signal.SIGTERM: "SIGTERM", signal.SIGHUP: "the terminal closed"}
ACKNOWLEDGE_AFTER_S = 0.4  # a command that has ended by then has said so itself


@dataclass
class _Promise:
    """What happens next after Ctrl-C, and after a second one; whether there was a first."""

    what: str
    again: str
    first_came: bool = False

    def text(self, number: int) -> str:
        """What happens next after this signal; other signals than Ctrl-C do not count."""
        came, self.first_came = self.first_came, self.first_came or number == signal.SIGINT
        return self.again if came and number == signal.SIGINT else self.what


STILL = "still at that step; ends as soon as it is done"
_NEXT = [_Promise("ends as soon as the step at work is done", STILL)]


@contextmanager
def promising(what: str, again: str = STILL) -> Iterator[None]:
    """Within the block, an interrupt is acknowledged with this text: what happens next.

    Args:
        what: happens after an interrupt.
        again: happens after a second Ctrl-C.
    """
    _NEXT.append(_Promise(what, again))
    try:
        yield
    finally:
        _NEXT.pop()


@contextmanager
def acknowledging(say: Callable[[str], None] = warn, after_s: float = ACKNOWLEDGE_AFTER_S) -> Iterator[None]:
    """Says what happens next when a signal comes whose work takes longer than a moment.

    A thread of its own says it, since Python's handlers wait for compiled code to return. Outside the
    main thread nothing is said.

    Args:
        say: prints a line.
        after_s: how long the block may take to end without an acknowledgement.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _NEXT[0].first_came = False
    ended = threading.Event()
    mine, theirs = socket.socketpair()
    with mine, theirs:
        theirs.setblocking(False)
        before = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
        watcher = threading.Thread(target=_acknowledge, args=(mine, ended, say, after_s), daemon=True)
        watcher.start()
        try:
            yield
        finally:
            ended.set()
            signal.set_wakeup_fd(before)
            with suppress(OSError):
                theirs.shutdown(socket.SHUT_WR)
            watcher.join()


def _acknowledge(
    signals: socket.socket, ended: threading.Event, say: Callable[[str], None], after_s: float
) -> None:
    """Says a line for every signal that ends commands, until the other end closes."""
    while came := signals.recv(64):
        for number in came:
            if number in NAMES and not ended.wait(after_s):
                say(f"tilenca: {NAMES[signal.Signals(number)]}: {_NEXT[-1].text(number)}")


@contextmanager
def ending_like_ctrl_c() -> Iterator[None]:
    """SIGTERM and a closed terminal end the block with KeyboardInterrupt, so that it can clean up.

    A signal that the parent process ignores (`nohup`) stays ignored.
    """

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = {number: signal.getsignal(number) for number in SIGNALS}
    heeded = {number: handler for number, handler in before.items() if handler is not signal.SIG_IGN}
    for number in heeded:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number, handler in heeded.items():
            signal.signal(number, handler)


@contextmanager
def held_back() -> Iterator[None]:
    """An interrupt during the block is delivered right after it, so that every started child is known."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    numbers = (signal.SIGINT, *SIGNALS)
    before = {number: signal.getsignal(number) for number in numbers}
    heeded = {number: handler for number, handler in before.items() if callable(handler)}
    for number in heeded:
        signal.signal(number, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        for number, handler in heeded.items():
            signal.signal(number, handler)
    if came:
        raise KeyboardInterrupt


@contextmanager
def deaf_to_ctrl_c() -> Iterator[None]:
    """Processes started in this context ignore Ctrl-C, until they handle it themselves."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
