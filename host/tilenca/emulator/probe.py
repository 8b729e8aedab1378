"""Eyes on an emulated tile's pins: edges, the bytes that they spell, and waveform files for GTKWave."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.emulator.library import call, new

CHUNK = 4096
# A cycle of 16 MHz is 62.5 ns.
VCD_UNITS_PER_S = 10_000_000_000
VCD_TIMESCALE = "100 ps"
# What a waveform file may call a signal by.
FIRST_NAME, NAMES = 33, 94


@dataclass(frozen=True)
class Edge:
    """A pin began to have another level.

    Attributes:
        time_s: seconds since the array began.
        level: the new one.
    """

    time_s: float
    level: bool


@dataclass(frozen=True)
class WireByte:
    """A byte that was seen on a wire, as 8N1.

    Attributes:
        time_s: when its stop bit was, in seconds since the array began.
        value: 0..255.
        framing_error: whether the stop bit was low.
    """

    time_s: float
    value: int
    framing_error: bool


@dataclass(frozen=True)
class WireFrame:
    """What stood between two delimiters on a wire.

    Attributes:
        time_s: when its closing delimiter's stop bit was, in seconds since the array began.
        data: the bytes, without delimiters.
    """

    time_s: float
    data: bytes


def pin_port(port: str) -> bytes:
    """A port's letter as the library wants it.

    Raises:
        UsageError: it is not one letter.
    """
    if len(port) != 1 or not port.isascii():
        raise UsageError(f"no port '{port}'; ports are A to L without I")
    return port.encode()


class PinProbe:
    """The edges of one pin since it was made. Made by `EmulatedTile.probe`."""

    def __init__(self, handle: Callable[[], Any], tile: int, port: str, bit: int) -> None:
        self.name = f"P{port}{bit}"
        self.tile = tile
        self._handle = handle
        self._number = call("probe_new", handle(), tile, pin_port(port), bit, -1.0)

    @property
    def level(self) -> bool:
        """The level before the first edge that has not been read yet."""
        return bool(call("probe_level", self._handle(), self._number))

    def read(self) -> list[Edge]:
        """The edges since the last call, in order."""
        times, levels = new("double[]", CHUNK), new("uint8_t[]", CHUNK)
        edges: list[Edge] = []
        while count := call("probe_edges", self._handle(), self._number, times, levels, CHUNK):
            edges += [Edge(times[i], bool(levels[i])) for i in range(count)]
        return edges

    def close(self) -> None:
        """Looks away; costs nothing any more."""
        call("probe_free", self._handle(), self._number)


class WireTap:
    """The bytes on one wire since it was made. Made by `EmulatedTile.tap`."""

    def __init__(self, handle: Callable[[], Any], tile: int, port: str, bit: int, baud: float) -> None:
        self._handle = handle
        self._number = call("probe_new", handle(), tile, pin_port(port), bit, baud)
        self._frame = bytearray()

    def read(self) -> list[WireByte]:
        """The bytes since the last call, in order."""
        times, values, errors = new("double[]", CHUNK), new("uint8_t[]", CHUNK), new("uint8_t[]", CHUNK)
        seen: list[WireByte] = []
        while count := call("probe_bytes", self._handle(), self._number, times, values, errors, CHUNK):
            seen += [WireByte(times[i], values[i], bool(errors[i])) for i in range(count)]
        return seen

    def read_frames(self, delimiter: int = 0) -> list[WireFrame]:
        """The frames completed since the last call: what stands between two delimiters, and is not empty."""
        frames = []
        for byte in self.read():
            if byte.value != delimiter:
                self._frame.append(byte.value)
            elif self._frame:
                frames.append(WireFrame(byte.time_s, bytes(self._frame)))
                self._frame.clear()
        return frames

    def close(self) -> None:
        """Looks away; costs nothing any more."""
        call("probe_free", self._handle(), self._number)


def _identifier(number: int) -> str:
    text = ""
    while True:
        text += chr(FIRST_NAME + number % NAMES)
        number //= NAMES
        if number == 0:
            return text


class Waveforms:
    """Collects the edges of probes and writes them as a value change dump.

    waves = Waveforms([array[0].probe("H", 1), array[0].probe("K", 7)])
    array.run(0.1)
    waves.write(Path("tile.vcd"))
    """

    def __init__(self, probes: Sequence[PinProbe]) -> None:
        self._probes = list(probes)
        self._levels = [probe.level for probe in self._probes]
        self._edges: list[tuple[float, int, bool]] = []

    def collect(self) -> None:
        """Takes what the probes have seen; a long run takes less memory with calls in between."""
        for number, probe in enumerate(self._probes):
            self._edges += [(edge.time_s, number, edge.level) for edge in probe.read()]

    def write(self, path: Path) -> None:
        """Writes everything seen so far. One scope a tile, one signal a pin; times in 100 ps."""
        self.collect()
        lines = [f"$timescale {VCD_TIMESCALE} $end"]
        for tile in sorted({probe.tile for probe in self._probes}):
            lines.append(f"$scope module tile{tile + 1} $end")
            lines += [
                f"$var wire 1 {_identifier(number)} {probe.name} $end"
                for number, probe in enumerate(self._probes)
                if probe.tile == tile
            ]
            lines.append("$upscope $end")
        lines += ["$enddefinitions $end", "#0", "$dumpvars"]
        lines += [f"{level:d}{_identifier(number)}" for number, level in enumerate(self._levels)]
        lines.append("$end")
        last = 0
        for time_s, number, level in sorted(self._edges):
            moment = round(time_s * VCD_UNITS_PER_S)
            if moment != last:
                lines.append(f"#{moment}")
                last = moment
            lines.append(f"{level:d}{_identifier(number)}")
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
