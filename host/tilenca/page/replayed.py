"""A recording for the page: one of the page itself, or one of `--record`, told as the page tells of tiles."""

import io
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_json
from tilenca.fleet.grid import Grid
from tilenca.fleet.recording import read_recording
from tilenca.fleet.state import Event, PortNews
from tilenca.page.fleet_teller import LOOK_S, FleetTeller
from tilenca.page.recording_file import check_recording
from tilenca.protocol.stream import StreamEvent, pace_event, run_event, stream_event

# Times below are of emulated tiles, and count from the run's beginning.
LONGEST_S = 86_400.0 * 365


def page_recording(
    path: Path,
    labels: Sequence[str],
    labels_of: Callable[[int], Sequence[str] | None],
    grid: Grid | None = None,
) -> str:
    """The recording as the page takes it: a line of JSON for each event.

    Args:
        path: a file that the page, `tilenca monitor --record` or `tilenca emulate --record` wrote.
        labels: of the classes, until tiles say which model they run.
        labels_of: the labels of the model with an id, or None.
        grid: finds the places that are not recorded.

    Raises:
        UsageError: it cannot be read, or is none.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; give a file that --record or the page wrote") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: not a recording; give a file that --record or the page wrote") from error
    if not _is_of_page(text):
        grid = grid or Grid()
        events = _told(read_recording(path, grid.lay), grid, labels, labels_of)
        lines = [json.dumps(event) + "\n" for event in events]
        if len(lines) <= 3:
            raise UsageError(f"{path}: nothing is recorded in it")
        return check_recording(path, lines)
    # Raw lines have other ends of line in them.
    return check_recording(path, io.StringIO(text, newline="\n").readlines())


def _is_of_page(text: str) -> bool:
    """Whether the first line of a file is that of a recording of the page, of any version."""
    try:
        first = read_json(text.lstrip().partition("\n")[0])
    except ValueError:
        return False
    return isinstance(first, dict) and "stream" in first


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
