"""A port behind which a test speaks as a tile."""

import os
import select
import tty
from typing import Self

from tilenca.protocol.sentences import TileSentence, format_sentence

LIMIT_S = 60
STATE = bytes([128]) * 21


class Tile:
    """A tile's USB serial as a pseudo-terminal; use it as a context manager."""

    def __init__(self, tile: int) -> None:
        self.tile = tile
        self.updates = 0
        self._told = b""

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

    def read_line(self) -> bytes:
        """The next line that the tile is told, without its end; fails if none comes."""
        while b"\n" not in self._told:
            ready, _, _ = select.select([self._master], [], [], LIMIT_S)
            assert ready, f"tile {self.tile} was told nothing but {self._told!r}"
            self._told += os.read(self._master, 4096)
        line, _, self._told = self._told.partition(b"\n")
        return line.strip()

    def say(self, label: str = "4") -> None:
        self.updates += 1
        self.write(
            format_sentence(
                TileSentence(
                    self.tile, 100 * self.updates, self.updates, label, int(label), 30, "N-SW", STATE
                )
            )
        )
