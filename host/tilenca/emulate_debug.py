"""`tilenca emulate --vcd` and `--gdb`: looking closely at tiles of a run."""

import re
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tilenca.emulation import Emulation
from tilenca.emulator import Waveforms
from tilenca.emulator_gdb import GdbPort
from tilenca.errors import UsageError
from tilenca.streams import warn

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
    """Records chosen pins while the block runs, and writes them to a file when it ends, however it does.

    Raises:
        UsageError: a pin is none, or the file cannot be written.
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


@contextmanager
def debuggers(emulation: Emulation, given: Sequence[str]) -> Iterator[list[GdbPort]]:
    """Opens a remote port for each `TILE[:PORT]`, and waits until a debugger is at each.

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
            port.wait()
        yield ports


def attend(ports: Sequence[GdbPort]) -> None:
    """Does what debuggers ask for; returns when all let the tiles go on."""
    for port in ports:
        port.serve()
    while halted := [port for port in ports if port.connected and not port.goes]:
        for port in halted:
            port.serve(timeout_s=0.2)
