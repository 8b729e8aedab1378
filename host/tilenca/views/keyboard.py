"""Keys as they are typed, without Enter; the terminal is restored however the program ends or stops."""

import os
import re
import select
import signal
import sys
import termios
import time
import tty
from contextlib import suppress
from types import FrameType
from typing import Self

from tilenca.base.signals import held_back

# An arrow, another sequence, one that has not come to its end, or a plain character.
_KEY = re.compile(
    rb"\x1b(?:\[[0-9;]*|O)(?P<arrow>[A-D])|\x1b\[[0-?]*[ -/]*[@-~]|\x1b(?P<partial>\[[0-?]*[ -/]*|O)?\Z"
    rb"|\x1bO.|(?P<plain>[^\x1b])|\x1b",
    re.DOTALL,
)
ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}


def parse_keys(data: bytes) -> tuple[list[str], bytes]:
    """The keys in a terminal's bytes: characters, `up`, `down`, `left`, `right`; and an unfinished rest."""
    keys = []
    for found in _KEY.finditer(data):
        if found["arrow"]:
            keys.append(ARROWS[found["arrow"]])
        elif found["plain"]:
            keys.append(found["plain"].decode("latin-1"))
        elif found.end() == len(data) and found[0] == b"\x1b" + (found["partial"] or b""):
            return keys, found[0]
    return keys, b""


def is_ours(descriptor: int) -> bool:
    """Whether it is a terminal and this program is in its foreground, so that the keys are for it."""
    if not os.isatty(descriptor):
        return False
    try:
        return os.tcgetpgrp(descriptor) == os.getpgrp()
    except OSError:  # a terminal without jobs
        return True


def our_terminal() -> int | None:
    """The descriptor of standard input where its keys are for this program; None where it is closed, too."""
    if sys.stdin is None or sys.stdin.closed:
        return None
    try:
        descriptor = sys.stdin.fileno()
    except OSError:  # something else stands for it
        return None
    return descriptor if is_ours(descriptor) else None


class Keyboard:
    """A terminal's keys; use it as a context manager."""

    def __init__(self, descriptor: int, screen: int) -> None:
        """Prepares to read from a terminal that `is_ours`; the cursor on `screen` is hidden by the caller."""
        self._descriptor, self._screen = descriptor, screen
        self._before = termios.tcgetattr(descriptor)
        self._taken = False
        self._partial = b""

    def __enter__(self) -> Self:
        self._take()
        # Ctrl-Z and Ctrl-\ give the terminal back before their usual action.
        self._handlers = {
            number: signal.signal(number, handler)
            for number, handler in (
                (signal.SIGTSTP, self._leave),
                (signal.SIGQUIT, self._leave),
                (signal.SIGCONT, self._return),
            )
        }
        return self

    def __exit__(self, *about: object) -> None:
        with held_back():
            self._give_back()
            for number, handler in self._handlers.items():
                signal.signal(number, handler)

    def _take(self) -> None:
        tty.setcbreak(self._descriptor, termios.TCSANOW)
        self._taken = True

    def _give_back(self) -> None:
        if self._taken:
            self._taken = False
            termios.tcsetattr(self._descriptor, termios.TCSANOW, self._before)

    def _leave(self, number: int, frame: FrameType | None) -> None:
        self._show(b"\x1b[?25h")
        self._give_back()
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)  # here we stop, or end
        signal.signal(number, self._leave)

    def _return(self, number: int, frame: FrameType | None) -> None:
        if is_ours(self._descriptor):
            self._take()
            self._show(b"\x1b[?25l")

    def _show(self, cursor: bytes) -> None:
        if self._taken:
            with suppress(OSError):  # the terminal has gone
                os.write(self._screen, cursor)

    def wait(self, seconds: float) -> list[str]:
        """Waits for keys, at most so long; returns those typed, see `parse_keys`."""
        if not self._taken:
            time.sleep(seconds)
            return []
        ready, _, _ = select.select([self._descriptor], [], [], seconds)
        if not (ready and self._taken):
            return []
        try:
            data = os.read(self._descriptor, 1024)
        except OSError:
            data = b""
        if not data:
            self._taken = False  # the terminal has gone
        keys, self._partial = parse_keys(self._partial + data)
        return keys
