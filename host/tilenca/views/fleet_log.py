"""The monitor's output without a picture: a line for each event, for each change, or JSON."""

import json
from collections.abc import Sequence

from tilenca.base.stdio import warn
from tilenca.fleet.events import Reporter, news_line
from tilenca.fleet.grid import Grid
from tilenca.fleet.state import Event, Fleet, as_json
from tilenca.protocol.line_reader import Heard
from tilenca.views.fleet_table import log_line


class Lines:
    """Shows a fleet's events on stdout; those of a recording begin `start_s` after its first."""

    def __init__(self, start_s: float) -> None:
        self._start_s = start_s
        self._from_s: float | None = None

    def show(self, now_s: float, events: Sequence[Event]) -> None:
        """Shows events, just taken by the fleet."""
        for event in events:
            if self._from_s is None:
                self._from_s = event.time_s + self._start_s
            self.tell(event, shown=event.time_s >= self._from_s)
        if events:
            print(end="", flush=True)

    def tell(self, event: Event, *, shown: bool) -> None:
        """Tells one event; with `shown` False, only takes note of it."""
        raise NotImplementedError


class JsonLines(Lines):
    """Good sentences as JSON on stdout, all else on stderr."""

    def tell(self, event: Event, *, shown: bool) -> None:
        """See `Lines.tell`."""
        if shown and isinstance(event, Heard) and event.sentence is not None:
            print(json.dumps(as_json(event)))
        elif shown:
            warn(log_line(event))


class EventLines(Lines):
    """Every event as a line on stdout."""

    def tell(self, event: Event, *, shown: bool) -> None:
        """See `Lines.tell`."""
        if shown:
            print(log_line(event))


class NewsLines(Lines):
    """Each change as a line on stdout: the log that stands below the picture."""

    def __init__(self, start_s: float, fleet: Fleet, grid: Grid) -> None:
        super().__init__(start_s)
        self._reporter = Reporter(fleet, grid)

    def tell(self, event: Event, *, shown: bool) -> None:
        """See `Lines.tell`."""
        for news in self._reporter.take(event):
            if shown:
                print(news_line(news))
