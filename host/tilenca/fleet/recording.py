"""Telemetry on disk: JSON lines with time, port and raw bytes, so that later readers can parse them anew.

A line from a tile is `{"time", "port", "raw"}`, news of a port `{"time", "port", "open", "reason"}`, and the
place of a tile, as far as it is known, `{"time", "port", "place", "tile"}`.
"""

import fnmatch
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self, TypeAlias

from tilenca.base.errors import NoDeviceError, TilencaError, UsageError
from tilenca.base.parsing import read_json
from tilenca.base.stdio import warn
from tilenca.fleet.grid import Laid
from tilenca.fleet.state import Event, PortNews
from tilenca.fleet.tiles_file import FAR, MAX_TILE_ID
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import parse_sentence
from tilenca.protocol.stream import KINDS, RAW_ENCODING, StreamEvent, open_event, place_event, raw_event

# No line is so long.
LONGEST = 1 << 20

# The last moment that every calendar function accepts.
LAST_S = 253_402_300_799.0


# Hears where the tile behind a port lies from now on; None: it was taken away.
Lay: TypeAlias = Callable[[str, Laid | None], None]


@dataclass(frozen=True)
class Placed:
    """Where the tile behind a port lies from now on; None: it was taken away."""

    time_s: float
    port: str
    laid: Laid | None


def as_record(event: Event) -> StreamEvent:
    """The event as one JSON object."""
    if isinstance(event, Heard):
        return raw_event(event.time_s, event.port, event.raw)
    return open_event(event.time_s, event.port, event.is_open, event.reason)


def format_event(event: Event) -> str:
    """The event as one line, newline included."""
    return json.dumps(as_record(event)) + "\n"


class Recorder:
    """A recording in the making; use it as a context manager."""

    def __init__(self, path: Path, mode: str) -> None:
        """Opens the file, to write it anew (`w`) or to append (`a`).

        Raises:
            UsageError: it cannot be opened, is no recording, or its last line is cut off, so that appended
                lines could not be read.
        """
        self._path = path
        self._laid: dict[str, Laid] = {}
        try:
            if mode == "a" and path.is_file() and not _begins_well(path):
                raise UsageError(f"{path}: not a recording; give --record another file")
            if mode == "a" and path.is_file() and not _ends_well(path):
                raise UsageError(f"{path}: its last line is cut off; give --record another file")
            self._file = path.open(mode, encoding="ascii")
        except OSError as error:
            raise UsageError(f"{path}: {error.strerror}; give --record a file that can be written") from error

    def place(self, time_s: float, laid: Mapping[str, Laid], **about: object) -> None:
        """Writes where all tiles lie that one knows of, as far as it is news.

        Args:
            time_s: since when.
            laid: by port.
            about: further keys of these lines.

        Raises:
            TilencaError: there is no room.
        """
        gone = [place_event(time_s, port, None) for port in self._laid if port not in laid]
        news = [
            place_event(time_s, port, at.place, at.tile)
            for port, at in laid.items()
            if self._laid.get(port) != at
        ]
        self._laid = dict(laid)
        self.write(json.dumps(event | about) + "\n" for event in (*gone, *news))

    def write(self, lines: Iterable[str]) -> None:
        """Writes whole lines, at once.

        Raises:
            TilencaError: there is no room.
        """
        try:
            self._file.writelines(lines)
            self._file.flush()
        except OSError as error:
            raise TilencaError(
                f"{self._path}: {error.strerror}; the recording ends here, give --record another file"
            ) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *about: object) -> None:
        with suppress(OSError):  # the failed write was reported already
            self._file.close()


def _begins_well(path: Path) -> bool:
    with path.open("rb") as file:
        first = file.readline(LONGEST)
    try:
        if first:
            parse_event(first.decode("ascii"))
        return True
    except ValueError:
        return not first.endswith(b"\n") and first.startswith(b'{"time": ')  # cut off in its first line


def _ends_well(path: Path) -> bool:
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(size - 1, 0))
        return file.read() in (b"", b"\n")


def parse_event(line: str) -> Event | Placed | None:
    """The event of a line; None for one of the stream that is of no use here, such as a cable.

    Raises:
        ValueError: it is none.
    """
    about = read_json(line)
    match about:
        case {"time": float() | int() as time_s} if not 0 <= time_s <= LAST_S:
            raise ValueError(f"{time_s} is no time in seconds since 1970")
        case {"time": float() | int() as time_s, "port": str(port), "raw": str(text)}:
            raw = text.encode(RAW_ENCODING)
            return Heard(float(time_s), port, raw, parse_sentence(raw))
        case {
            "time": float() | int() as time_s,
            "port": str(port),
            "open": bool(is_open),
            "reason": str(reason),
        }:
            return PortNews(float(time_s), port, is_open, reason)
        case {"time": float() | int() as time_s, "port": str(port), "place": place} if _subjects(about) == 1:
            return Placed(float(time_s), port, _laid(place, about.get("tile")))
        case {"time": float() | int()} if _subjects(about) == 1:
            if "raw" not in about and "open" not in about:
                return None
    raise ValueError("neither a line nor news of a port")


def _subjects(about: Mapping[str, object]) -> int:
    """How many kinds of events a line has keys of; one, if it is right."""
    return sum(kind in about for kind in KINDS)


def _laid(place: object, tile: object) -> Laid | None:
    """A tile's place, checked.

    Raises:
        ValueError: it is none.
    """
    if place is None:
        return None
    match place:
        case [int(row), int(col)] if all(type(n) is int and abs(n) <= FAR for n in (row, col)):
            if tile is None or (type(tile) is int and 1 <= tile <= MAX_TILE_ID):
                return Laid((row, col), tile)
    raise ValueError(f"a place is [row, column], -{FAR} to {FAR}, and a tile's id 1 to {MAX_TILE_ID}")


def nowhere(port: str, laid: Laid | None) -> None:
    """Passes over where tiles lie."""


class Choice:
    """The events of those ports of a recording that match patterns, and notes on all of it."""

    def __init__(self, path: Path, patterns: Sequence[str], lay: Lay = nowhere) -> None:
        """Reads nothing yet; `lay` hears where tiles lie, as the recording says it."""
        self._path, self._patterns, self._lay = path, patterns, lay
        self._ports: dict[str, bool] = {}
        self._length_s = 0.0
        self._complete = False

    def __iter__(self) -> Iterator[Event]:
        first_s: float | None = None
        for event in read_recording(self._path, self._lay_chosen):
            if event.port not in self._ports:
                self._ports[event.port] = self._matches(event.port)
            if self._ports[event.port]:
                first_s = event.time_s if first_s is None else first_s
                self._length_s = max(self._length_s, event.time_s - first_s)
                yield event
        self._complete = True

    def _lay_chosen(self, port: str, laid: Laid | None) -> None:
        if self._matches(port):
            self._lay(port, laid)

    def _matches(self, port: str) -> bool:
        """By a port's whole name or the end of it: `tiles.toml` has names from `/` on."""
        return not self._patterns or any(
            fnmatch.fnmatchcase(port, pattern) or fnmatch.fnmatchcase(port, f"*/{pattern}")
            for pattern in self._patterns
        )

    def complain(self, start_s: float) -> None:
        """Reports why nothing was shown, if so.

        Raises:
            NoDeviceError: no port matches.
        """
        if not self._complete:
            return  # a person has ended it
        if not self._ports:
            warn(f"{self._path}: nothing is recorded in it")
        elif not any(self._ports.values()):
            raise NoDeviceError(
                f"{self._path}: no port matches {' '.join(self._patterns)}; it has {', '.join(self._ports)}"
            )
        elif start_s > self._length_s:
            warn(f"{self._path}: --from {start_s:g} is past its end, at {self._length_s:.1f} s")


def read_recording(path: Path, lay: Lay = nowhere) -> Iterator[Event]:
    """The events of a file, in its order.

    Args:
        path: what `--record` wrote.
        lay: hears where tiles lie, before the events that follow.

    Raises:
        UsageError: the file cannot be read, or a line is no event; the message names the line.
    """
    try:
        with path.open(encoding="ascii") as file:
            yield from _events(path, file, lay)
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give a file that --record wrote") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not a recording; give a file that --record wrote") from error


def _events(path: Path, lines: Iterable[str], lay: Lay) -> Iterator[Event]:
    for number, line in enumerate(lines, start=1):
        try:
            event = parse_event(line)
        except ValueError as error:
            if line.endswith("\n"):
                raise UsageError(
                    f"{path}:{number}: not a recorded event ({error}); give a file that --record wrote"
                ) from error
            warn(f"{path}:{number}: cut off in its middle; the recording ends before it")
            return
        if isinstance(event, Placed):
            lay(event.port, event.laid)
        elif event is not None:
            yield event


def recorded_shapes(path: Path) -> list[str]:
    """The shapes of which `emulate --record` wrote runs into a file, in its order; else none."""
    shapes: dict[str, None] = {}
    with suppress(OSError, UnicodeDecodeError), path.open(encoding="ascii") as file:
        for line in file:
            with suppress(ValueError):
                match read_json(line):
                    case {"shape": str(shape)}:
                        shapes[shape] = None
    return list(shapes)
