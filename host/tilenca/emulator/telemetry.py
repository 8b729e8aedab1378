"""The lines that emulated tiles say on USB, each with its time."""

from tilenca.emulator.tile import EmulatedTile
from tilenca.emulator.types import port_name
from tilenca.protocol.line_reader import Heard, LineReader


def heard_from(tile: EmulatedTile, reader: LineReader) -> list[Heard]:
    """The tile's lines since the last call; each has the time of the byte that completed it.

    Args:
        tile: whose port is called `tile-01`, ...
        reader: of this tile only; it keeps the beginning of a line that is not complete.
    """
    data, arrived = tile.read_serial_timed()
    port = port_name(tile.index)
    return [Heard(arrived[at], port, raw, sentence) for at, (raw, sentence) in reader.feed_at(data)]
