"""Commands of pages on their way to real tiles: a tile gets them in turn, and none waits for another tile."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from tilenca.base.errors import UsageError
from tilenca.fleet.command import Commands, Reply
from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Event, Fleet
from tilenca.protocol.stream import StreamEvent, refused_event

MOST_ORDERS = 64
UNREACHED = "no tile can be reached now"

Deliver: TypeAlias = Callable[[list[StreamEvent]], None]


@dataclass(frozen=True)
class Order:
    """A command for tiles.

    Attributes:
        name: of the command.
        line: its bytes.
        port: of the tile; None: all tiles.
        answer: hears of what went wrong.
    """

    name: str
    line: bytes
    port: str | None
    answer: Deliver


@dataclass
class _Underway:
    order: Order
    commands: Commands
    waiting: set[str] = field(default_factory=set)


class Orders:
    """Carries orders out, a bit at each call: it waits for nothing."""

    def __init__(self, reader: PortReader, fleet: Fleet, done: Callable[[Order, str], None]) -> None:
        """Has no order yet.

        Args:
            reader: of the tiles' ports.
            fleet: what they have said.
            done: called with an order and each port behind which a tile has acknowledged it.
        """
        self._reader, self._fleet, self._done = reader, fleet, done
        self._waiting: list[Order] = []
        self._underway: list[_Underway] = []

    def add(self, order: Order) -> None:
        """Adds an order.

        Raises:
            UsageError: no port that it goes to is open, or too many orders wait.
        """
        view = self._fleet.tiles.get(order.port or "")
        if order.port is not None and (view is None or not view.is_open):
            raise UsageError(f"{order.port}: cannot be reached now{f' ({view.reason})' if view else ''}")
        if not self._ports_of(order):
            raise UsageError(UNREACHED)
        if len(self._waiting) >= MOST_ORDERS:
            raise UsageError("the tiles have not answered the last commands yet; wait a moment")
        self._waiting.append(order)

    def _ports_of(self, order: Order) -> set[str]:
        """The ports that an order goes to now: of one for all, those behind which a tile has spoken."""
        open_views = [view for view in self._fleet.tiles.values() if view.is_open]
        if order.port is not None:
            return {view.port for view in open_views if view.port == order.port}
        return {view.port for view in open_views if view.sentences}

    def go_on(self) -> None:
        """Sends what is due."""
        busy = {port for one in self._underway for port in one.waiting}
        later = []
        for order in self._waiting:
            ports = self._ports_of(order)
            if not ports:
                order.answer([refused_event(0.0, f"{order.port}: went away" if order.port else UNREACHED)])
            elif busy & ports:
                later.append(order)
            else:
                commands = Commands(self._reader, dict.fromkeys(sorted(ports), order.line), order.name)
                self._underway.append(_Underway(order, commands, set(ports)))
            busy |= ports
        self._waiting = later
        for one in self._underway:
            for port, reply in one.commands.send().items():
                self._end(one, port, reply)
        self._underway = [one for one in self._underway if one.waiting]

    def take(self, event: Event) -> None:
        """An event of a port: it may answer an order."""
        for one in self._underway:
            if reply := one.commands.take(event):
                self._end(one, event.port, reply)

    def _end(self, one: _Underway, port: str, reply: Reply) -> None:
        one.waiting.discard(port)
        if reply.problem:
            one.order.answer([refused_event(0.0, f"{port}: {reply.problem}")])
        else:
            self._done(one.order, port)
