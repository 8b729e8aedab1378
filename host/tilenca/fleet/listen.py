"""Listens to a fleet: its ports, and those that come later or come back under another name."""

import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from tilenca.base.errors import NoDeviceError, TilencaError
from tilenca.base.stdio import warn
from tilenca.fleet.boards import Found, find_boards, find_fleet, load_places
from tilenca.fleet.grid import Grid
from tilenca.fleet.ports import MAGIC
from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Event

# How often to look for boards that came back under another name.
LOOK_AROUND_S = 3.0
# How long patterns that match nothing may do so: an emulation is up in a second or two.
PATIENCE_S = 8.0
TICK_S = 0.2


class Listener:
    """The ports of a fleet, open; use it as a context manager.

    Attributes:
        reader: of the ports.
        grid: the tiles' places, as far as the file of tiles and the tiles themselves tell them.
    """

    def __init__(self, patterns: Sequence[str], tiles: Path | None, user: str = "tilenca monitor") -> None:
        """Finds the ports; patterns get a while, since tiles that were just started may still be coming.

        Args:
            patterns: of `--port`.
            tiles: of `--tiles`.
            user: the command's name for others that want a port.

        Raises:
            NoDeviceError: there is none.
            UsageError: the file of tiles is wrong.
        """
        self._patterns, self._tiles = patterns, tiles
        self._found = _awaited(patterns, tiles)
        self._found.tell_others()
        self.reader = PortReader([board.port.name for board in self._found.boards], user=user)
        self.grid = Grid(load_places(tiles))
        self.grid.know(self._found)
        self._look_s = time.monotonic() + LOOK_AROUND_S

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.reader.__exit__(kind, error, trace)

    def poll(self, timeout_s: float) -> list[Event]:
        """Waits at most `timeout_s` for events; returns them. Looks around for other ports now and then."""
        if time.monotonic() >= self._look_s:
            self._look_s = time.monotonic() + LOOK_AROUND_S
            self._look_around()
        return self.reader.poll(timeout_s)

    def _look_around(self) -> None:
        """Adds what has come since: a board may come back under another name."""
        if not (self._found.missing or self.reader.closed or any(map(MAGIC.search, self._patterns))):
            return
        try:
            now = find_boards(self._patterns, self._tiles)
        except TilencaError:
            return  # no board is there now, or the file is being edited
        self.reader.add([board.port.name for board in now.boards])
        self.grid.know(now)


def _awaited(patterns: Sequence[str], tiles: Path | None) -> Found:
    """The boards, for which patterns get a while."""
    end_s = time.monotonic() + PATIENCE_S
    told, before = False, 0
    while True:
        try:
            found = find_fleet(patterns, tiles)
            if not told or len(found.boards) == before:
                return found
            before = len(found.boards)  # they come one after the other: look once more
        except NoDeviceError:
            if not any(map(MAGIC.search, patterns)) or time.monotonic() >= end_s:
                raise
        if not told:
            warn(f"nothing matches {' '.join(patterns)} yet; waiting up to {PATIENCE_S:g} s for it")
            told = True
        time.sleep(TICK_S)
