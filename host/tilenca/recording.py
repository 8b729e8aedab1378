"""Telemetry on disk: JSON lines of what was heard, when and where; raw, for readers yet to be written.

A line from a tile is `{"time", "port", "raw"}`, news of a port `{"time", "port", "open", "reason"}`.
"""

import json
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Self

from tilenca.errors import TilencaError, UsageError
from tilenca.protocol import parse_sentence
from tilenca.telemetry import Event, Heard, PortNews

# Every byte is a character of Latin-1 and back.
ENCODING = "latin-1"

# An event so near is due: less than this a clock's own rounding may never reach.
DUE_S = 1e-3


def as_record(event: Event) -> dict[str, object]:
    """The event as one JSON object."""
    about: dict[str, object] = {"time": round(event.time_s, 6), "port": event.port}
    if isinstance(event, Heard):
        about["raw"] = event.raw.decode(ENCODING)
    else:
        about |= {"open": event.is_open, "reason": event.reason}
    return about


def format_event(event: Event) -> str:
    """The event as one line, newline included."""
    return json.dumps(as_record(event)) + "\n"


class Recorder:
    """A recording in the making; use it as a context manager."""

    def __init__(self, path: Path, mode: str) -> None:
        """Opens the file, to write it anew (`w`) or to append (`a`).

        Raises:
            UsageError: it cannot be opened.
        """
        self._path = path
        try:
            self._file = path.open(mode, encoding="ascii")
        except OSError as error:
            raise UsageError(f"{path}: {error.strerror}; give --record a file that can be written") from error

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
        with suppress(OSError):  # what could not be written has been told
            self._file.close()


def parse_event(line: str) -> Event:
    """The event of a line.

    Raises:
        ValueError: it is none.
    """
    about = json.loads(line)
    match about:
        case {"time": float() | int() as time_s, "port": str(port), "raw": str(text)}:
            raw = text.encode(ENCODING)
            return Heard(float(time_s), port, raw, parse_sentence(raw))
        case {
            "time": float() | int() as time_s,
            "port": str(port),
            "open": bool(is_open),
            "reason": str(reason),
        }:
            return PortNews(float(time_s), port, is_open, reason)
    raise ValueError("neither a line nor news of a port")


def read_recording(path: Path) -> Iterator[Event]:
    """The events of a file, in its order.

    Raises:
        UsageError: the file cannot be read, or a line is no event; the message names the line.
    """
    try:
        with path.open(encoding="ascii") as file:
            for number, line in enumerate(file, start=1):
                try:
                    yield parse_event(line)
                except ValueError as error:
                    raise UsageError(
                        f"{path}:{number}: not a recorded event ({error}); give a file that --record wrote"
                    ) from error
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give a file that --record wrote") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not a recording; give a file that --record wrote") from error


def paced(
    events: Iterable[Event],
    speed: float,
    tick_s: float,
    start_s: float = 0.0,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Iterator[tuple[float, list[Event]]]:
    """Plays events back as they came, `speed` times as fast; 0: without any wait.

    What came in the first `start_s` seconds is played at once.

    Yields:
        The recording's time now in seconds since 1970, and the events that are due; at least every `tick_s`.
    """
    began_s = clock()
    first_s: float | None = None
    for event in events:
        first_s = event.time_s if first_s is None else first_s
        offset_s = event.time_s - first_s - start_s
        while speed and (wait_s := offset_s / speed - (clock() - began_s)) > DUE_S:
            sleep(min(wait_s, tick_s))
            yield first_s + start_s + (clock() - began_s) * speed, []
        yield event.time_s, [event]
