"""`tilenca monitor`: tiles in their places as a live picture, a log, or JSON; recorded, played back."""

import argparse
import fnmatch
import json
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol, TypeAlias

from rich.console import Console

from tilenca.arguments import not_negative
from tilenca.boards import Found, add_fleet_arguments, find_boards, find_fleet, load_places
from tilenca.errors import NoDeviceError, TilencaError
from tilenca.fleetgrid import Grid
from tilenca.fleetlive import LiveView
from tilenca.fleetview import log_line, summary
from tilenca.portreader import PortReader
from tilenca.ports import MAGIC
from tilenca.recording import Recorder, format_event, paced, read_recording
from tilenca.streams import warn
from tilenca.telemetry import Event, Fleet, Heard, as_json

# The time, and what has come by then.
Events: TypeAlias = Iterator[tuple[float, list[Event]]]

TICK_S = 0.2
# How often to look for boards that came back under another name.
LOOK_AROUND_S = 3.0
# How long patterns that match nothing may do so: an emulation is up in a second or two.
PATIENCE_S = 8.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_fleet_arguments(parser)
    parser.add_argument("--json", action="store_true", help="one JSON object per sentence on stdout")
    parser.add_argument(
        "--seconds", type=not_negative, metavar="S", help="end after S seconds (default: at Ctrl-C)"
    )
    storage = parser.add_mutually_exclusive_group()
    storage.add_argument(
        "--record", type=Path, metavar="F", help="append all that is heard to F, with its time"
    )
    storage.add_argument("--replay", type=Path, metavar="F", help="show a recording instead of reading ports")
    parser.add_argument(
        "--speed",
        type=not_negative,
        default=1.0,
        metavar="X",
        help="replay X times as fast; 0: at once (default: 1)",
    )
    parser.add_argument(
        "--from",
        type=not_negative,
        default=0.0,
        dest="start",
        metavar="S",
        help="start the replay S seconds after the recording's beginning",
    )
    parser.add_argument("--table", action="store_true", help="on a terminal: one line per port, no picture")


def run(args: argparse.Namespace) -> int:
    """Shows events until the end or an interrupt; see `tilenca monitor --help`."""
    fleet = Fleet()
    try:
        with ExitStack() as stack:
            if args.replay:
                source, grid = _replay(args), Grid(load_places(args.tiles))
            else:
                source, grid = _listen(args, stack)
            record = stack.enter_context(Recorder(args.record, "a")) if args.record else None
            display: Display = _JsonLines() if args.json else _display(args, fleet, grid, stack)
            _show(source, fleet, display, record, args.seconds)
    finally:
        if fleet.tiles:
            warn(summary(fleet.tiles.values()))
    return 0 if args.replay or all(view.was_open for view in fleet.tiles.values()) else 1


class Display(Protocol):
    """Shows the fleet and what is new; called at least every TICK_S."""

    def show(self, now_s: float, events: Sequence[Event]) -> None:
        """Shows events, just taken by the fleet."""


def _show(
    source: Events,
    fleet: Fleet,
    display: Display,
    record: Recorder | None,
    seconds: float | None,
) -> None:
    began_s: float | None = None
    for now_s, events in source:
        began_s = now_s if began_s is None else began_s
        if seconds is not None and now_s - began_s > seconds:
            return
        for event in events:
            fleet.take(event)
        if record and events:
            record.write(map(format_event, events))
        display.show(now_s, events)


def _listen(args: argparse.Namespace, stack: ExitStack) -> tuple[Events, Grid]:
    """Events from the ports, which are found (or not) before anything is shown."""
    found = _awaited(args)
    found.tell_others()
    reader = stack.enter_context(PortReader([board.port.name for board in found.boards]))
    grid = Grid(load_places(args.tiles))
    grid.know(found)

    def events() -> Events:
        look_s = time.monotonic() + LOOK_AROUND_S
        while True:
            news = reader.poll(TICK_S)
            yield time.time(), news
            if time.monotonic() >= look_s:
                look_s = time.monotonic() + LOOK_AROUND_S
                _look_around(args, found, reader, grid)

    return events(), grid


def _look_around(args: argparse.Namespace, found: Found, reader: PortReader, grid: Grid) -> None:
    """Adds what has come since: a board may come back under another name."""
    if not (found.missing or reader.closed or any(map(MAGIC.search, args.port))):
        return
    try:
        now = find_boards(args.port, args.tiles)
    except TilencaError:
        return  # nothing is there now, or somebody is editing the file
    reader.add([board.port.name for board in now.boards])
    grid.know(now)


def _awaited(args: argparse.Namespace) -> Found:
    """The boards, for which patterns get a while: tiles that were just started may still be coming."""
    end_s = time.monotonic() + PATIENCE_S
    told, before = False, 0
    while True:
        try:
            found = find_fleet(args.port, args.tiles)
            if not told or len(found.boards) == before:
                return found
            before = len(found.boards)  # they come one after the other: look once more
        except NoDeviceError:
            if not any(map(MAGIC.search, args.port)) or time.monotonic() >= end_s:
                raise
        if not told:
            warn(f"nothing matches {' '.join(args.port)} yet; waiting up to {PATIENCE_S:g} s for it")
            told = True
        time.sleep(TICK_S)


def _replay(args: argparse.Namespace) -> Events:
    """Events from a recording, of the ports that match."""
    chosen = (
        event
        for event in read_recording(args.replay)
        if not args.port or any(fnmatch.fnmatchcase(event.port, pattern) for pattern in args.port)
    )
    return paced(chosen, args.speed, TICK_S, args.start)


class _JsonLines:
    """Good sentences as JSON on stdout, all else on stderr."""

    def show(self, now_s: float, events: Sequence[Event]) -> None:
        for event in events:
            if isinstance(event, Heard) and event.sentence is not None:
                print(json.dumps(as_json(event)))
            else:
                warn(log_line(event))
        if events:
            print(end="", flush=True)


class _LogLines:
    """Every event as a line on stdout."""

    def show(self, now_s: float, events: Sequence[Event]) -> None:
        for event in events:
            print(log_line(event))
        if events:
            print(end="", flush=True)


def _display(args: argparse.Namespace, fleet: Fleet, grid: Grid, stack: ExitStack) -> Display:
    console = Console()
    if not console.is_terminal:
        return _LogLines()
    about = f"replay of {args.replay}, {args.speed:g} times as fast" if args.replay else ""
    display = LiveView(fleet, grid, console, args.table, about)
    stack.enter_context(display.live)
    return display
