"""A lab of emulated tiles served as ports in this process, so that a test can pull and plug their cables."""

import queue
import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from tilenca.emulate_serve import STOCK_BOOTLOADER, ServedTile, keep_step
from tilenca.emulation import Conditions, Emulation, firmware_settings, port_name
from tilenca.shapes import load_task

LIMIT_S = 120


class _OverError(Exception):
    """The lab closes."""


class Lab:
    """Tiles with the stock bootloader, wired as one drawing; use it as a context manager."""

    def __init__(self, elf: Path, folder: Path, rows: list[str]) -> None:
        """Will serve the tiles of `rows` ('#' is one) as `folder`/tile-01 and so on."""
        shapes = folder / "lab.toml"
        shapes.write_text('[[shape]]\nlabel = "8"\ngrid = """\n' + "\n".join(rows) + '\n"""\n')
        task = load_task(shapes)
        conditions = Conditions(seconds=None, bootloader=STOCK_BOOTLOADER, boot_spread_s=0.0)
        self.folder = folder
        self.pattern = f"{folder}/tile-*"
        self._emulation = Emulation(task, task.shapes[0], elf, conditions, firmware_settings(elf))
        self._served: dict[int, ServedTile] = {}
        self._orders: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def port(self, tile: int) -> str:
        """The port of a tile; they count from 1."""
        return str(self.folder / port_name(tile - 1))

    def __enter__(self) -> Self:
        for tile in range(1, len(self._emulation.array) + 1):
            self._plug(tile)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._orders.put(_end)
        self._thread.join(LIMIT_S)
        assert not self._thread.is_alive(), "the lab hangs"
        for port in self._served.values():
            port.close()
        self._emulation.array.close()

    def _serve(self) -> None:
        while True:
            try:
                keep_step(self._emulation, list(self._served.values()), None, self._carry_out)
            except _OverError:
                return
            except _ChangedError:
                continue

    def _carry_out(self) -> None:
        changed = False
        while not self._orders.empty():
            self._orders.get()()
            changed = True
        if changed:
            raise _ChangedError

    def do(self, order: Callable[[], None]) -> None:
        """Does something between two steps, and waits until it is done."""
        done = threading.Event()

        def carried_out() -> None:
            order()
            done.set()

        self._orders.put(carried_out)
        assert done.wait(LIMIT_S), "the lab does not step on"

    @property
    def time_s(self) -> float:
        """The tiles' own time."""
        return self._emulation.array.time_s

    def pass_time(self, seconds: float) -> None:
        """Waits so long in the tiles' own time."""
        end_s = self.time_s + seconds
        while self.time_s < end_s:
            self.do(lambda: None)

    def unplug(self, tile: int) -> None:
        """Its port vanishes, whoever has it open; the tile goes on."""
        self.do(lambda: self._served.pop(tile).close())

    def plug(self, tile: int) -> None:
        """Its port is there again."""
        self.do(lambda: self._plug(tile))

    def _plug(self, tile: int) -> None:
        array = self._emulation.array
        self._served[tile] = ServedTile(array[tile - 1], Path(self.port(tile)), reset_on_open=True)


class _ChangedError(Exception):
    """Ports have come or gone."""


def _end() -> None:
    raise _OverError
