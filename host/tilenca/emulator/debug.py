"""`tilenca emulate --vcd`, `--frames` and `--gdb`: details of the tiles of a run."""

import json
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TextIO

from tilenca.base.errors import UsageError
from tilenca.base.sides import SIDES
from tilenca.base.stdio import warn
from tilenca.emulator.experiment import Emulation
from tilenca.emulator.gdb import WAIT_S, GdbPort
from tilenca.emulator.probe import Waveforms
from tilenca.emulator.traffic import Traffic

PIN = re.compile(r"([0-9]+):P?([A-HJ-L])([0-7])")
TILE_AND_PORT = re.compile(r"([0-9]+)(?::([0-9]+))?")


def _tile(emulation: Emulation, number: str, option: str, given: str) -> int:
    count = len(emulation.array)
    if not 1 <= int(number) <= count:
        raise UsageError(
            f"{option} {given}: no tile {number}; shape '{emulation.shape.name}' has 1 to {count}"
        )
    return int(number) - 1


@contextmanager
def waveforms(emulation: Emulation, path: Path | None, pins: Sequence[str]) -> Iterator[Waveforms | None]:
    """Records chosen pins while the block runs, and writes them to a file however the block ends.

    Raises:
        UsageError: there is no such pin, or the file cannot be written.
    """
    if path is None:
        yield None
        return
    probes = []
    for pin in pins:
        match = PIN.fullmatch(pin)
        if match is None:
            raise UsageError(f"--pin {pin}: not a tile and a pin; for example 3:H1 for PH1 of tile 3")
        tile = _tile(emulation, match[1], "--pin", pin)
        probes.append(emulation.array[tile].probe(match[2], int(match[3])))
    if not probes:
        probes = [tile.probe(*tile.side_pin(side)) for tile in emulation.array for side in range(4)]
    waves = Waveforms(probes)
    try:
        yield waves
    finally:
        try:
            waves.write(path)
        except OSError as error:
            raise UsageError(f"{path}: {error.strerror}; give --vcd a file that can be written") from error


class FrameLog:
    """Writes the traffic of each cable: a JSON object for every frame, in order of their ends."""

    def __init__(self, emulation: Emulation, file: TextIO) -> None:
        """Watches all cables from now on."""
        self._file = file
        self._traffic = Traffic(emulation.array, emulation.cables)

    def collect(self) -> None:
        """Writes the frames that have ended since the last call."""
        for frame in self._traffic.read():
            line = {
                "time": round(frame.time_s, 6),
                "tile": frame.tile + 1,
                "side": SIDES[frame.side],
                "frame": frame.data.hex(),
            }
            self._file.write(json.dumps(line) + "\n")


@contextmanager
def frames(emulation: Emulation, path: Path | None) -> Iterator[FrameLog | None]:
    """Writes the frames on all cables to a file while the block runs.

    Raises:
        UsageError: the file cannot be written.
    """
    if path is None:
        yield None
        return
    try:
        with path.open("w", encoding="ascii") as file:
            yield FrameLog(emulation, file)
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give --frames a file that can be written") from error


@contextmanager
def debuggers(
    emulation: Emulation, given: Sequence[str], stopped: Callable[[], bool]
) -> Iterator[list[GdbPort]]:
    """Opens a remote port for each `TILE[:PORT]`, and waits until a debugger is at each, or `stopped`.

    Raises:
        UsageError: no such tile, or the port is taken.
    """
    with ExitStack() as stack:
        ports = []
        for text in given:
            match = TILE_AND_PORT.fullmatch(text)
            if match is None:
                raise UsageError(f"--gdb {text}: not a tile and a port; for example 7 or 7:3333")
            tile = emulation.array[_tile(emulation, match[1], "--gdb", text)]
            ports.append(GdbPort(emulation.array, tile, int(match[2] or 0)))
            stack.callback(ports[-1].close)
        for port, text in zip(ports, given, strict=True):
            warn(f"tile {text.partition(':')[0]} waits for: avr-gdb -ex 'target remote :{port.port}'")
        for port in ports:
            port.wait(stopped)
        yield ports


def attend(ports: Sequence[GdbPort], stopped: Callable[[], bool]) -> None:
    """Serves the debuggers' requests; returns when all let the tiles go on, or `stopped`."""
    for port in ports:
        port.serve()
    while (halted := [port for port in ports if port.connected and not port.goes]) and not stopped():
        for port in halted:
            port.serve(timeout_s=WAIT_S)
