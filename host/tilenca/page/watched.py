"""Real or served tiles behind the page: ports that are read once, for all pages that look at them."""

import threading
import time
import traceback
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Self

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.stdio import warn
from tilenca.emulator.arrangement import FOR_EVER, STOPPED_UPDATES
from tilenca.fleet.listen import Listener
from tilenca.fleet.recording import Recorder, format_event
from tilenca.fleet.state import Event
from tilenca.page.fleet_teller import LOOK_S, FleetTeller
from tilenca.page.orders import Deliver, Order, Orders
from tilenca.page.session import EndedError
from tilenca.protocol import stream_commands as commands
from tilenca.protocol import stream_hands as hands
from tilenca.protocol.commands import ask_command, blink_command, restart_command, set_command
from tilenca.protocol.stream import StreamEvent, pace_event, refused_event, run_event, stream_event

# What a page can do with real tiles; the rest only a hand at the tiles can.
TAKES = ("rest", "freeze", "blink", "restart", "set", "seen")
POLL_S = 0.05
# A tile that speaks and has not said what it runs is asked for it, so often.
ASK_S = 5.0
REFUSAL = "these are real tiles: only a hand at the table can do that"


class Watch:
    """Reads the ports of a fleet in a thread of its own, and tells all who listen; a context manager."""

    def __init__(
        self,
        listener: Listener,
        labels: Sequence[str],
        labels_of: Callable[[int], Sequence[str] | None],
        record: Recorder | None = None,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """Reads nothing until it is entered.

        Args:
            listener: of the ports; entered.
            labels: of the classes, until tiles say which model they run.
            labels_of: the labels of the model with an id, or None.
            record: gets all that the ports say.
            clock: seconds since 1970.
        """
        self._listener, self._record, self._clock = listener, record, clock
        self.began_s = clock()
        self._teller = FleetTeller(listener.grid, labels, labels_of, self.began_s)
        self._lock = threading.RLock()
        self._listeners: list[Deliver] = []
        self._orders = Orders(listener.reader, self._teller.fleet, self._note_done)
        self._broken = ""
        self._thawed: dict[str, int] = {}
        self._asked_s: dict[str, float] = {}
        self._looked_s = 0.0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="tilenca-page-watch", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()

    # --- for the pages, in their threads ---

    def join(self, deliver: Deliver) -> list[StreamEvent]:
        """From now on `deliver` is called with what is news, in the watch's thread.

        Returns:
            All that is known, the stream's first event included.

        Raises:
            EndedError: the tiles are not read any more.
        """
        with self._lock:
            self.check()
            self._listeners.append(deliver)
            now_s = self._clock()
            first = stream_event("watched", looks=self._teller.told_looks(), takes=list(TAKES))
            run = run_event(0.0, {"seed": 0, "shape": "-", "tiles": len(self._teller.fleet.tiles)})
            run["run"]["began"] = round(self.began_s, 3)
            return [first, run, *self._teller.all(now_s), self._pace(now_s)]

    def leave(self, deliver: Deliver) -> None:
        """`deliver` is called no more."""
        with self._lock:
            self._listeners.remove(deliver)

    def check(self) -> None:
        """Raises EndedError with the reason where the tiles are not read any more."""
        if self._broken:
            raise EndedError(self._broken)

    def order(self, name: str, line: bytes, port: str | None, answer: Deliver) -> None:
        """Sends a command to the tile behind a port, or to all; `answer` hears of what went wrong.

        Raises:
            UsageError: no port that it goes to is open, or too many commands wait.
            EndedError: the tiles are not read any more.
        """
        with self._lock:
            self.check()
            self._orders.add(Order(name, line, port, answer))

    def updates_of(self, port: str, frozen: bool) -> int:
        """The setting `updates` that freezes a tile, or lets it go on as it did before it was frozen here."""
        with self._lock:
            view = self._teller.fleet.tiles.get(port)
            if not frozen:
                return self._thawed.pop(port, FOR_EVER)
            if view is not None and view.hello is not None and view.hello.updates != STOPPED_UPDATES:
                self._thawed[port] = view.hello.updates
            return STOPPED_UPDATES

    # --- in its thread ---

    def _run(self) -> None:
        try:
            while not self._ended.is_set():
                self._carry_out()
                for event in self._listener.poll(POLL_S):
                    self._hear(event)
                self._look()
        except TilencaError as error:
            self._break_off(str(error))
        except Exception as error:  # a mistake of ours: nobody must wait for tiles that are not read
            traceback.print_exc()
            self._break_off(f"the tiles are not read any more: {type(error).__name__}: {error}")

    def _break_off(self, reason: str) -> None:
        warn(f"tilenca: {reason}")
        with self._lock:
            self._broken = reason

    def _hear(self, event: Event) -> None:
        with self._lock:
            self._tell(self._teller.take(event))
            self._keep(event)
            view = self._teller.fleet.tiles[event.port]
            if view.is_open and view.tile and not view.hello:
                asked_s = self._asked_s.get(event.port, 0.0)
                if self._clock() - asked_s >= ASK_S:
                    self._ask(event.port)
            self._orders.take(event)

    def _ask(self, port: str) -> None:
        self._asked_s[port] = self._clock()
        if self._listener.reader.write(port, ask_command()):
            with self._lock:
                self._teller.asked(port, self._asked_s[port])

    def _keep(self, event: Event) -> None:
        if self._record is None:
            return
        try:
            self._record.place(event.time_s, self._listener.grid.known())
            self._record.write([format_event(event)])
        except TilencaError as error:
            self._record = None
            warn(f"tilenca: {error}")
            self._tell([refused_event(0.0, f"nothing more is recorded: {error}")])

    def _look(self) -> None:
        now_s = self._clock()
        with self._lock:
            if 0 <= now_s - self._looked_s < LOOK_S:
                return
            self._looked_s = now_s
            self._tell([*self._teller.look(now_s), self._pace(now_s)])

    def _pace(self, now_s: float) -> StreamEvent:
        return pace_event(max(now_s - self.began_s, 0.0), 1.0, False, 1.0, None)

    def _tell(self, events: list[StreamEvent]) -> None:
        for deliver in self._listeners:
            deliver(events)

    def _carry_out(self) -> None:
        with self._lock:
            self._orders.go_on()

    def _note_done(self, order: Order, port: str) -> None:
        if order.name == "SET":
            self._ask(port)  # so that the page knows what is in force


class WatchedSource:
    """One page's view of a watch; see `tilenca.page.session.Source`."""

    def __init__(self, watch: Watch) -> None:
        """Joins at `begin`."""
        self._watch = watch
        self._events: list[StreamEvent] = []
        self._lock = threading.Lock()
        self._joined = False

    def _hear(self, events: list[StreamEvent]) -> None:
        with self._lock:
            self._events += events

    def begin(self) -> list[StreamEvent]:
        """What is here, and all that is known of it.

        Raises:
            EndedError: the tiles are not read any more.
        """
        told = self._watch.join(self._hear)
        self._joined = True
        return told

    def take(self, command: commands.StreamCommand) -> None:
        """Passes on what tiles can be told over USB.

        Raises:
            UsageError: they cannot be told that, or not now.
            EndedError: they are not read any more.
        """
        order = self._watch.order
        match command:
            case hands.Freeze(port, on):
                order("SET", set_command("updates", self._watch.updates_of(port, on)), port, self._hear)
            case hands.Set(name, value, port):
                order("SET", set_command(name, value), port, self._hear)
            case hands.Blink(port, seconds):
                order("BLINK", blink_command(seconds), port, self._hear)
            case hands.Restart(port):
                order("RESTART", restart_command(), port, self._hear)
            case commands.Rest():
                pass  # they go on anyhow
            case _:
                raise UsageError(REFUSAL)

    def advance(self, wall_s: float) -> list[StreamEvent]:
        """What has come meanwhile.

        Raises:
            EndedError: all has been told, and the tiles are not read any more.
        """
        with self._lock:
            events, self._events = self._events, []
        if not events:
            self._watch.check()
        return events

    @property
    def is_idle(self) -> bool:
        """Tiles never are."""
        return False

    def abandon(self) -> None:
        """Nothing takes long here."""

    def close(self) -> None:
        """Leaves the watch, which goes on."""
        if self._joined:
            self._watch.leave(self._hear)
