"""A recording for the page: one of the page itself, or one of `--record`, told as the page tells of tiles."""

import io
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_json
from tilenca.base.stdio import warn
from tilenca.fleet.grid import Grid
from tilenca.fleet.recording import read_recording
from tilenca.fleet.state import Event, PortNews
from tilenca.fleet.tiles_file import Place
from tilenca.page.fleet_teller import LOOK_S, FleetTeller
from tilenca.protocol.stream import STREAM_VERSION, StreamEvent, pace_event, run_event, stream_event

# Times below are of emulated tiles, and count from the run's beginning.
LONGEST_S = 86_400.0 * 365
# What the page takes.
MOST_EVENTS = 2_000_000
MOST_TIME_S = 1e7
MOST_TEXT = 4096
MOST_PLACE = 1000
BEGINNING = ("stream", "run")
CHOOSE = "give a recording of the page or of --record"


def page_recording(
    path: Path,
    labels: Sequence[str],
    labels_of: Callable[[int], Sequence[str] | None],
    places: Sequence[Place] = (),
) -> str:
    """The recording as the page takes it: a line of JSON for each event.

    Args:
        path: a file that the page, `tilenca monitor --record` or `tilenca emulate --record` wrote.
        labels: of the classes, until tiles say which model they run.
        labels_of: the labels of the model with an id, or None.
        places: of the tiles, where a file of tiles says them.

    Raises:
        UsageError: it cannot be read, or is none.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give a file that --record or the page wrote") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not a recording; give a file that --record or the page wrote") from error
    if (version := _version(text)) is None:
        events = _told(read_recording(path), Grid(places), labels, labels_of)
        lines = [json.dumps(event) for event in events]
        if len(lines) <= 3:
            raise UsageError(f"{path}: nothing is recorded in it")
        return _checked(path, "\n".join(lines) + "\n")
    if version != STREAM_VERSION:
        raise UsageError(f"{path}: it has version {version} of the stream, tilenca has {STREAM_VERSION}")
    return _checked(path, text)


def _checked(path: Path, text: str) -> str:
    """A recording of the page, without a last line that was cut off; see `page/stream/recording_file.js`.

    Raises:
        UsageError: the page would not show it.
    """
    kept: list[str] = []
    events = 0
    lines = io.StringIO(text, newline="\n").readlines()  # raw lines have other ends of line in them
    for number, line in enumerate(lines, start=1):
        if line.strip():
            try:
                event = read_json(line)
            except ValueError:
                if number < len(lines) or line.endswith("\n"):
                    raise UsageError(f"{path}:{number}: is no event; {CHOOSE}") from None
                warn(f"{path}:{number}: cut off in its middle; the recording ends before it")
                break
            if wrong := _wrong_with(event, events):
                raise UsageError(f"{path}:{number}: {wrong}; {CHOOSE}")
            events += 1
            if events > MOST_EVENTS:
                raise UsageError(f"{path}: it has more than {MOST_EVENTS} events; record a shorter run")
        kept.append(line)
    if events < len(BEGINNING):
        raise UsageError(f"{path}: it does not begin as a recording of the page does; {CHOOSE}")
    return "".join(kept)


def _wrong_with(event: object, before: int) -> str:
    """What is wrong with the event after so many; "" for nothing."""
    if not isinstance(event, dict):
        return "is no event"
    time_s = event.get("time")
    if not isinstance(time_s, int | float) or isinstance(time_s, bool) or not 0 <= time_s <= MOST_TIME_S:
        return f"has no time in 0..{MOST_TIME_S:g} s"
    if before < len(BEGINNING) and BEGINNING[before] not in event:
        return "it does not begin as a recording of the page does"
    if before >= len(BEGINNING) and any(name in event for name in BEGINNING):
        return "it has more than one run"
    if any(isinstance(value, str) and len(value) > MOST_TEXT for value in event.values()):
        return f"has a text of more than {MOST_TEXT} characters"
    place = event.get("place")
    if isinstance(place, list) and not all(isinstance(one, int) and abs(one) <= MOST_PLACE for one in place):
        return f"has a place beyond {MOST_PLACE}"
    return ""


def _version(text: str) -> object | None:
    """The version of the stream in the first line of a page's recording; None where it is another file."""
    try:
        first = read_json(text.partition("\n")[0])
    except ValueError:
        return None
    return first.get("stream") if isinstance(first, dict) else None


def _told(
    events: Iterable[Event],
    grid: Grid,
    labels: Sequence[str],
    labels_of: Callable[[int], Sequence[str] | None],
) -> Iterator[StreamEvent]:
    """The stream of a recording of `--record`."""
    teller: FleetTeller | None = None
    began_s = looked_s = now_s = 0.0
    for event in events:
        now_s = max(now_s, event.time_s)
        if teller is None:
            began_s = looked_s = event.time_s if event.time_s > LONGEST_S else 0.0
            teller = FleetTeller(grid, labels, labels_of, began_s)
            yield stream_event("watched", looks=teller.told_looks())
            yield run_event(0.0, {"seed": 0, "shape": "-", "tiles": 0, "began": round(began_s, 3)})
        if event.port not in teller.fleet.tiles and not isinstance(event, PortNews):
            yield from teller.take(PortNews(event.time_s, event.port, is_open=True))
        yield from teller.take(event)
        if now_s - looked_s >= LOOK_S:
            looked_s = now_s
            yield from teller.look(now_s)
    if teller is not None:
        yield from teller.look(now_s)
        end_s = now_s - began_s
        yield pace_event(end_s, 1.0, True, 1.0, end_s)
