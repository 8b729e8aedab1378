"""A port behind which a test speaks as a tile."""

import os
import tty
from typing import Self

from tilenca.protocol.sentences import TileSentence, format_sentence

STATE = bytes([128]) * 21


class Tile:
    """A tile's USB serial as a pseudo-terminal; use it as a context manager."""

    def __init__(self, tile: int) -> None:
        self.tile = tile
        self.updates = 0

    def __enter__(self) -> Self:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        return self

    def __exit__(self, *about: object) -> None:
        self.unplug()

    def unplug(self) -> None:
        """The port vanishes."""
        if self._master >= 0:
            os.close(self._master)
            os.close(self._slave)
            self._master = -1

    def write(self, data: bytes) -> None:
        os.write(self._master, data)

    def say(self, label: str = "4") -> None:
        self.updates += 1
        self.write(
            format_sentence(
                TileSentence(
                    self.tile, 100 * self.updates, self.updates, label, int(label), 30, "N-SW", STATE
                )
            )
        )
