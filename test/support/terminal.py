"""A terminal that a test looks at."""

import os
import re
import select
import sys
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pty import openpty

import pytest

LIMIT_S = 30
READ_LIMIT_S = 1200  # only a hang takes so long
SCREENFULS = 2_000_000  # characters
_ESCAPE = re.compile(r"\x1b\[[0-9;?]*[a-zA-Z]")


@pytest.fixture
def pty() -> Iterator[str]:
    """A port of which nobody has the other end."""
    master, slave = openpty()
    yield os.ttyname(slave)
    os.close(master)
    os.close(slave)


class Screen:
    """Collects all that is written on a pseudo-terminal."""

    def __init__(self, master: int) -> None:
        self._master = master
        self._written = b""
        self._thread = threading.Thread(target=self._collect, daemon=True)
        self._thread.start()

    def _collect(self) -> None:
        with suppress(OSError):  # the other end is closed
            while data := os.read(self._master, 4096):
                self._written += data

    def close(self) -> None:
        """Waits for the rest."""
        self._thread.join(LIMIT_S)
        assert not self._thread.is_alive(), "somebody has the terminal open"
        os.close(self._master)

    @property
    def text(self) -> str:
        """What was written, without colours and movements of the cursor."""
        return _ESCAPE.sub("", self._written.decode())


@contextmanager
def stderr_on_terminal(monkeypatch: pytest.MonkeyPatch, width: int = 100) -> Iterator[Screen]:
    """The standard error of this process is a terminal while the block runs; then its text is complete."""
    master, slave = openpty()
    tty.setraw(slave)
    monkeypatch.delenv("NO_COLOR", raising=False)
    # rich asks the terminal of the process for its size, or these; the stream it writes on it does not ask.
    for name, value in {"COLUMNS": str(width), "LINES": "24", "TERM": "xterm-256color"}.items():
        monkeypatch.setenv(name, value)
    screen = Screen(master)
    try:
        with os.fdopen(slave, "w") as stream, monkeypatch.context() as patch:
            patch.setattr(sys, "stderr", stream)
            yield screen
    finally:
        screen.close()


def read_until(screen: int, wanted: str) -> None:
    """Reads a terminal until it shows something; fails if it does not, or shows a lot else before."""
    seen = ""
    while wanted not in seen:
        ready, _, _ = select.select([screen], [], [], READ_LIMIT_S)
        assert ready, f"no {wanted!r} after {seen!r}"
        seen += os.read(screen, 65536).decode("utf-8", "replace")
        assert len(seen) < SCREENFULS, f"no {wanted!r} in {seen[:500]!r}"
