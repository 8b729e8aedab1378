"""A lab of emulated tiles served as ports in this process, so that a test can pull and plug their cables."""

import queue
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from support.owned_clock import OwnedClock
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.serve import STEP_S, STOCK_BOOTLOADER, ServedTile
from tilenca.emulator.types import port_name
from tilenca.shapes.file import load_task

LIMIT_S = 600
# avrdude waits five seconds of everybody's time for an answer: twenty tiles' step must not take that long.
LONGEST_STEP_S = 0.01
# While nobody has a port open, as when a command starts, time hardly passes: emulating twenty tiles takes a
# whole processor.
IDLE_STEP_S = 0.001
# No avrdude takes so long to react, however busy this machine is.
STANDSTILL_S = 10.0
# A bootloader's answer: this byte, a sequence number, the size (two bytes), a token, the body, a checksum.
# What the firmware says is text.
START, ENVELOPE = b"\x1b", 6


class Lab:
    """Tiles with the stock bootloader, wired as one drawing; use it as a context manager."""

    def __init__(self, elf: Path, folder: Path, rows: list[str]) -> None:
        """Will serve the tiles of `rows` ('#' is one) as `folder`/tile-01 and so on."""
        shapes = folder / "lab.toml"
        shapes.write_text('[[shape]]\nlabel = "8"\ngrid = """\n' + "\n".join(rows) + '\n"""\n')
        task = load_task(shapes)
        conditions = EmulationSettings(seconds=None, bootloader=STOCK_BOOTLOADER, boot_spread_s=0.0)
        self.folder = folder
        self.pattern = f"{folder}/tile-*"
        self._emulation = Emulation(task.shapes[0], task.labels, elf, conditions, firmware_settings(elf))
        self._clock = OwnedClock(folder / "clock")
        self.environment = self._clock.environment  # for the commands that use the lab
        self.talks_s: list[float] = []  # the tiles' time at each answer of a bootloader
        self._answers: dict[ServedTile, bytes] = {}  # what each bootloader has said of its present one
        self._served: dict[int, ServedTile] = {}
        self._is_watched = False  # whether a test waits for time to pass
        self._orders: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
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
        self._orders.put(None)
        self._thread.join(LIMIT_S)
        assert not self._thread.is_alive(), "the lab hangs"
        for port in self._served.values():
            port.close()
        self._emulation.array.close()

    def _serve(self) -> None:
        last_s = time.monotonic()
        while True:
            time.sleep(max(0.0, last_s + STEP_S - time.monotonic()))
            now_s = time.monotonic()
            in_use = self._is_watched or any(port.is_open for port in self._served.values())
            self._emulation.pass_time(min(now_s - last_s, LONGEST_STEP_S if in_use else IDLE_STEP_S))
            self._clock.seconds = self.time_s
            while not self._orders.empty():
                if (order := self._orders.get()) is None:
                    return
                order()
            last_s = now_s if self._await(self._exchange()) else time.monotonic()

    def _exchange(self) -> list[ServedTile]:
        """Serves the ports; returns those whose bootloader has come to the end of an answer."""
        ended = []
        for port in self._served.values():
            answer = self._answers.get(port, b"") + port.exchange()
            self._answers[port] = answer = answer[answer.find(START) :] if START in answer else b""
            size = ENVELOPE + int.from_bytes(answer[2:4], "big")
            if len(answer) >= max(size, ENVELOPE):
                self._answers[port] = b""
                self.talks_s.append(self.time_s)
                ended.append(port)
        return ended

    @staticmethod
    def _await(ports: list[ServedTile]) -> bool:
        """Lets the tiles' time stand still until avrdude has reacted to all answers; whether it need not.

        So how busy this machine is does not count.
        """
        end_s = time.monotonic() + STANDSTILL_S
        stood = False
        while time.monotonic() < end_s and not all(port.is_spoken_to() for port in ports):
            time.sleep(STEP_S / 4)
            stood = True
        return not stood

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
        self._is_watched = True
        while self.time_s < end_s:
            self.do(lambda: None)
        self._is_watched = False

    def unplug(self, tile: int) -> None:
        """Its port vanishes, whoever has it open; the tile goes on."""
        self.do(lambda: self._served.pop(tile).close())

    def plug(self, tile: int) -> None:
        """Its port is there again."""
        self.do(lambda: self._plug(tile))

    def _plug(self, tile: int) -> None:
        array = self._emulation.array
        self._served[tile] = ServedTile(array[tile - 1], Path(self.port(tile)), reset_on_open=True)
