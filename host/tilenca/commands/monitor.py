"""`tilenca monitor`: tiles in their places as a live picture, a log, or JSON; recorded, played back."""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol, TypeAlias

from rich.console import Console

from tilenca.base.errors import UsageError
from tilenca.base.signals import held_back
from tilenca.base.stdio import warn
from tilenca.commands.arguments import add_fleet_arguments, not_negative
from tilenca.fleet.boards import load_places
from tilenca.fleet.grid import Grid
from tilenca.fleet.listen import Listener
from tilenca.fleet.recording import Choice, Recorder, format_event
from tilenca.fleet.replay import KEYS, Player
from tilenca.fleet.state import Event, Fleet
from tilenca.views.fleet_live import LiveView
from tilenca.views.fleet_log import EventLines, JsonLines, NewsLines
from tilenca.views.fleet_table import summary
from tilenca.views.keyboard import Keyboard, our_terminal

# The time, and what has come by then.
Events: TypeAlias = Iterator[tuple[float, list[Event]]]

TICK_S = 0.2


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    add_fleet_arguments(parser)
    manner = parser.add_mutually_exclusive_group()
    manner.add_argument("--json", action="store_true", help="one JSON object per sentence on stdout")
    manner.add_argument("--log", action="store_true", help="one line per change, no picture")
    manner.add_argument("--table", action="store_true", help="on a terminal: one line per port, no picture")
    parser.add_argument(
        "--seconds",
        type=not_negative,
        metavar="S",
        help="end after S seconds, with --replay of the recording (default: at Ctrl-C)",
    )
    storage = parser.add_mutually_exclusive_group()
    storage.add_argument(
        "--record", type=Path, metavar="F", help="append all received lines to F, with their times"
    )
    storage.add_argument(
        "--replay",
        type=Path,
        metavar="F",
        help=f"show a recording instead of reading ports; on a terminal, {KEYS} (a pipe does not go back)",
    )
    parser.add_argument(
        "--speed",
        type=not_negative,
        metavar="X",
        help="with --replay: X times as fast; 0: at once (default: 1)",
    )
    parser.add_argument(
        "--from",
        type=not_negative,
        dest="start",
        metavar="S",
        help="with --replay: start S seconds after the recording's beginning",
    )


def run(args: argparse.Namespace) -> int:
    """Shows events until the end or an interrupt; see `tilenca monitor --help`."""
    for option, value in (("speed", args.speed), ("from", args.start)):
        if value is not None and not args.replay:
            raise UsageError(f"--{option} does nothing without --replay; add it, or leave --{option} out")
    fleet = Fleet()
    try:
        with ExitStack() as stack:
            if args.replay:
                grid = Grid(load_places(args.tiles), given=args.tiles is not None)
                choice = Choice(args.replay, args.port, grid.lay)
                speed = 1.0 if args.speed is None else args.speed
                player = Player(lambda: iter(choice), speed, TICK_S, args.start or 0.0)
                display = _display(args, fleet, grid, stack, player)
                start_s = args.start or 0.0
                _show(iter(player), fleet, display, args.seconds, start_s)
                choice.complain(start_s)
            else:
                listener = stack.enter_context(Listener(args.port, args.tiles))
                record = stack.enter_context(Recorder(args.record, "a")) if args.record else None
                display = _display(args, fleet, listener.grid, stack)
                _show(_kept(_heard(listener), listener.grid, record), fleet, display, args.seconds)
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
    seconds: float | None,
    start_s: float = 0.0,
) -> None:
    """Shows all that comes, until `seconds` after it has come `start_s` far."""
    began_s: float | None = None
    for now_s, events in source:
        began_s = now_s + start_s if began_s is None else began_s
        if seconds is not None and now_s - began_s > seconds:
            return
        for event in events:
            fleet.take(event)
        display.show(now_s, events)


def _heard(listener: Listener) -> Events:
    """What comes from the ports, without end."""
    while True:
        news = listener.poll(TICK_S)
        yield time.time(), news


def _kept(source: Events, grid: Grid, record: Recorder | None) -> Events:
    """The same, recorded, with the places that the file of tiles says."""
    for now_s, events in source:
        if record and events:
            record.place(events[0].time_s, grid.known())
            record.write(map(format_event, events))
        yield now_s, events


def _display(
    args: argparse.Namespace, fleet: Fleet, grid: Grid, stack: ExitStack, player: Player | None = None
) -> Display:
    """JSON if wanted; on a terminal the live picture, with keys for a recording; else lines."""
    start_s = args.start or 0.0
    if args.json:
        return JsonLines(start_s)
    if args.log:
        return NewsLines(start_s, fleet, grid)
    console = Console()
    if not console.is_terminal or console.is_dumb_terminal:
        return EventLines(start_s)
    about = f"replay of {args.replay}" if player else ""
    display = LiveView(fleet, grid, console, args.table, about)
    if player and (keys := our_terminal()) is not None:
        with held_back():  # a view that takes the terminal must give it back
            player.wait = stack.enter_context(Keyboard(keys, sys.stdout.fileno())).wait
        if args.replay.is_file():  # what comes through a pipe comes once
            player.begin_again = display.begin_again
        display.footer = lambda: f"{player.status}; {player.keys}"
    stack.enter_context(display.live)
    return display
