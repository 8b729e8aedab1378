"""`tilenca monitor`: the telemetry of all tiles as a live table, a log, or JSON; recorded, played back."""

import argparse
import fnmatch
import json
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from tilenca.arguments import add_port_argument, not_negative
from tilenca.errors import NoDeviceError
from tilenca.fleetview import live_table, log_line, summary
from tilenca.portreader import PortReader
from tilenca.ports import MAGIC, Port, find_ports
from tilenca.protocol import ErrorSentence, HelloSentence, OtherVersionSentence
from tilenca.recording import Recorder, format_event, paced, read_recording
from tilenca.streams import warn
from tilenca.telemetry import Event, Fleet, Heard, PortNews, as_json

TICK_S = 0.2
LOG_LINES = 8
# How long patterns that match nothing may do so: an emulation is up in a second or two.
PATIENCE_S = 8.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_port_argument(parser)
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


def run(args: argparse.Namespace) -> int:
    """Shows events until the end or an interrupt; see `tilenca monitor --help`."""
    fleet = Fleet()
    try:
        with ExitStack() as stack:
            source = _replay(args) if args.replay else _listen(args, stack)
            record = stack.enter_context(Recorder(args.record, "a")) if args.record else None
            display: Display = _JsonLines() if args.json else _display(fleet, stack)
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
    source: Iterator[tuple[float, list[Event]]],
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


def _listen(args: argparse.Namespace, stack: ExitStack) -> Iterator[tuple[float, list[Event]]]:
    """Events from the ports, which are found (or not) before anything is shown."""
    names = [port.name for port in _awaited_ports(args.port)]
    reader = stack.enter_context(PortReader(names))

    def events() -> Iterator[tuple[float, list[Event]]]:
        while True:
            news = reader.poll(TICK_S)
            yield time.time(), news

    return events()


def _awaited_ports(patterns: Sequence[str]) -> list[Port]:
    """The ports, for which patterns get a while: tiles that were just started may still be coming."""
    end_s = time.monotonic() + PATIENCE_S
    told, before = False, 0
    while True:
        try:
            found = find_ports(patterns)
            if not told or len(found) == before:
                return found
            before = len(found)  # they come one after the other: look once more
        except NoDeviceError:
            if not any(map(MAGIC.search, patterns)) or time.monotonic() >= end_s:
                raise
        if not told:
            warn(f"nothing matches {' '.join(patterns)} yet; waiting up to {PATIENCE_S:g} s for it")
            told = True
        time.sleep(TICK_S)


def _replay(args: argparse.Namespace) -> Iterator[tuple[float, list[Event]]]:
    """Events from a recording, of the ports that match."""
    chosen = (
        event
        for event in read_recording(args.replay)
        if not args.port or any(fnmatch.fnmatchcase(event.port, pattern) for pattern in args.port)
    )
    return paced(chosen, args.speed, TICK_S)


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


class _LiveTable:
    """The fleet's table, and below it the last remarkable lines."""

    def __init__(self, fleet: Fleet, console: Console) -> None:
        self._fleet = fleet
        self._log: deque[str] = deque(maxlen=LOG_LINES)
        self._now_s = 0.0
        self._shown_s = 0.0
        self.live = Live(console=console, auto_refresh=False, get_renderable=self._picture)

    def show(self, now_s: float, events: Sequence[Event]) -> None:
        self._now_s = now_s
        self._log.extend(log_line(event) for event in events if _remarkable(event))
        if time.monotonic() - self._shown_s >= TICK_S:
            self._shown_s = time.monotonic()
            self.live.refresh()

    def _picture(self) -> Group:
        log = Text("\n".join(self._log), no_wrap=True, overflow="ellipsis")
        return Group(live_table(self._fleet, self._now_s), Text(), log)


def _remarkable(event: Event) -> bool:
    if isinstance(event, PortNews) or event.sentence is None:
        return True
    return isinstance(event.sentence, HelloSentence | ErrorSentence | OtherVersionSentence)


def _display(fleet: Fleet, stack: ExitStack) -> Display:
    console = Console()
    if not console.is_terminal:
        return _LogLines()
    display = _LiveTable(fleet, console)
    stack.enter_context(display.live)
    return display
