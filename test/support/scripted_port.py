"""A port whose other end says and answers what a test wants."""

import os
import select
import threading
import tty
from collections.abc import Callable
from typing import Self

from tilenca.fleet.identify import STALE_S
from tilenca.protocol.sentences import HelloSentence

HELLO = HelloSentence(3, 7, 0xBEEF, 21, 10, 20, 0, 1, 0xABCDEF01, 255)
LIMIT_S = 30


class Device:
    """A port that says something again and again, and answers; use it as a context manager.

    Attributes:
        said: how often it has said it.
        heard: the lines that came, with their ends.
    """

    def __init__(
        self, says: bytes = b"", answer: Callable[[bytes, int], bytes] = lambda line, count: b""
    ) -> None:
        self._says, self._answer = says, answer
        self.heard: list[bytes] = []
        self.said = 0

    def __enter__(self) -> Self:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *about: object) -> None:
        os.write(self._slave, b"\n")
        self._thread.join(LIMIT_S)
        assert not self._thread.is_alive()
        os.close(self._master)
        os.close(self._slave)

    def _serve(self) -> None:
        buffer = b""
        while buffer != b"\n":
            ready, _, _ = select.select([self._master], [], [], STALE_S / 6)
            if not ready:
                os.write(self._master, self._says)
                self.said += 1
                continue
            buffer += os.read(self._master, 4096)
            while buffer.endswith(b"\r\n"):
                line, _, buffer = buffer.partition(b"\r\n")
                self.heard.append(line + b"\r\n")
                os.write(self._master, self._answer(self.heard[-1], len(self.heard)))
