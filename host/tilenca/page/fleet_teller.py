"""What the page is told of a fleet of real or served tiles: events of ports in, events of the stream out.

The monitor's own parts tell what there is: its grid the places and the links, its reporter what is news.
Owns no port and no clock.
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tilenca.fleet.events import Reporter
from tilenca.fleet.grid import Cell, Grid, Mark, Position
from tilenca.fleet.recording import as_record
from tilenca.fleet.state import Event, Fleet, PortNews, TileView
from tilenca.page.outbox import MOST_NOTES, subject_of
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import HelloSentence, TileSentence
from tilenca.protocol.stream import (
    StreamEvent,
    classes_event,
    display_event,
    health_event,
    note_event,
    open_event,
    place_event,
)
from tilenca.shapes.file import UNKNOWN
from tilenca.shapes.glyphs import Look, look_of, looks_of

# So often it looks at the fleet as a whole.
LOOK_S = 0.1
NO_PORT = "no port"
NO_LINKS = "----"
# A tile that was asked for its HELLO answers by then; a later one is a start.
ANSWER_S = 2.0
# What a tile has said, of what a HELLO at its start makes void.
SAID = ("tile", "links", "health", "time", "error", "board", "board_before")


@dataclass(frozen=True)
class _Shown:
    """What the page has been told of one tile."""

    place: Position
    tile: int | None
    display: tuple[int, tuple[int, int, int], str]
    trouble: str
    links: dict[str, tuple[str, float | None]]


class FleetTeller:
    """Adds up what ports say, and tells the page what is news.

    Attributes:
        fleet: as the ports have told it.
    """

    def __init__(
        self,
        grid: Grid,
        labels: Sequence[str],
        labels_of: Callable[[int], Sequence[str] | None],
        began_s: float,
    ) -> None:
        """Knows no tile yet.

        Args:
            grid: finds the tiles' places.
            labels: of the classes, until tiles say which model they run.
            labels_of: the labels of the model with an id, or None.
            began_s: the time that is 0 on the page, in seconds since 1970.
        """
        self.fleet = Fleet()
        self._grid, self._labels_of, self._began_s = grid, labels_of, began_s
        self._reporter = Reporter(self.fleet)
        self.looks: list[Look] = looks_of(labels if UNKNOWN in labels else [*labels, UNKNOWN])
        self._models: set[int] = set()
        self._asked: dict[str, float] = {}
        self._notes: deque[StreamEvent] = deque(maxlen=MOST_NOTES)
        self._shown: dict[str, _Shown] = {}
        self._last: dict[tuple[str, str, str], StreamEvent] = {}

    # --- news ---

    def take(self, event: Event) -> list[StreamEvent]:
        """An event of a port, and what it changes in words."""
        if isinstance(event, PortNews) and not event.is_open:
            self._asked.pop(event.port, None)
        told = as_record(event)
        told["time"] = self._page_s(event.time_s)
        answers = self._answers(event)
        if answers:
            told["asked"] = True
            self._take_answer(event)
        else:
            self.fleet.take(event)
        if isinstance(event, Heard):
            self._last[(event.port, *subject_of(told["raw"]))] = told
        news = [] if answers else self._reporter.take(event)
        notes = [note_event(told["time"], one.port, one.text, one.bad) for one in news]
        self._notes.extend(notes)
        return [*self._classes(event, told["time"]), told, *notes]

    def asked(self, port: str, now_s: float) -> None:
        """The tile behind a port is asked for its HELLO at `now_s`, in seconds since 1970.

        The next one is no start of the tile, if it comes soon.
        """
        self._asked[port] = now_s

    def _answers(self, event: Event) -> bool:
        """Whether an event is a HELLO that was asked for."""
        if not isinstance(getattr(event, "sentence", None), HelloSentence):
            return False
        asked_s = self._asked.pop(event.port, None)
        return asked_s is not None and event.time_s - asked_s <= ANSWER_S

    def _take_answer(self, event: Event) -> None:
        """Adds a HELLO that was asked for: what the tile has said before still holds."""
        view = self.fleet.tiles[event.port]
        said = {name: getattr(view, name) for name in SAID}
        self.fleet.take(event)
        for name, value in said.items():
            setattr(view, name, value)

    def _classes(self, event: Event, time_s: float) -> list[StreamEvent]:
        """The classes anew, where a tile runs another model, or shows what none of them is called."""
        before = list(self.looks)
        match getattr(event, "sentence", None):
            case HelloSentence(model_id=model_id) if model_id not in self._models:
                self._models.add(model_id)
                if labels := self._labels_of(model_id):
                    known = {look.label for look in looks_of(labels)}
                    self.looks = looks_of(labels) + [one for one in self.looks if one.label not in known]
            case TileSentence(label=label, class_index=int(index)):
                if label and all(look.label != label for look in self.looks):
                    self.looks = [*self.looks, look_of(label, index)]
        return [] if self.looks == before else [classes_event(time_s, self.told_looks())]

    def told_looks(self) -> list[dict[str, object]]:
        """The looks of all classes, as the stream has them."""
        return [
            {"label": look.label, "segments": look.segments, "rgb": list(look.colour)} for look in self.looks
        ]

    def look(self, now_s: float) -> list[StreamEvent]:
        """What lies where, what it shows, and how it is, as far as it is news; `now_s` since 1970."""
        time_s, events = self._page_s(now_s), []
        seen = {
            cell.port or f"(tile {cell.tile})": (place, cell)
            for place, cell in self._grid.cells(self.fleet, now_s).items()
        }
        for port in self._shown.keys() - seen.keys():
            del self._shown[port]
            events.append(place_event(time_s, port, None))
        for port, (place, cell) in seen.items():
            before, now = self._shown.get(port), self._shown_of(place, cell)
            self._shown[port] = now
            if before is None or (before.place, before.tile) != (now.place, now.tile):
                events.append(place_event(time_s, port, place, tile=cell.tile))
            if before is None and cell.port is None:
                events.append(open_event(time_s, port, False, NO_PORT))
            if before is None or before.display != now.display:
                events.append(display_event(time_s, port, *now.display))
            if before is None or (before.trouble, before.links) != (now.trouble, now.links):
                events.append(health_event(time_s, port, now.trouble, now.links))
        return events

    def _shown_of(self, place: Position, cell: Cell) -> _Shown:
        view = self.fleet.tiles.get(cell.port or "", TileView(""))
        links = {
            side: (mark.name.lower(), view.health[side].good if side in view.health else None)
            for side, mark in cell.marks.items()
            if mark is not Mark.NONE
        }
        return _Shown(place, cell.tile, _display(view), cell.trouble, links)

    def _page_s(self, time_s: float) -> float:
        return round(max(time_s - self._began_s, 0.0), 6)

    # --- everything ---

    def all(self, now_s: float) -> list[StreamEvent]:
        """Everything, for a page that knows nothing; lines have the times at which they were said.

        What is news stays so for the pages that know the rest.
        """
        time_s, shown, self._shown = self._page_s(now_s), self._shown, {}
        ports = [
            open_event(time_s, view.port, view.is_open, view.reason) for view in self.fleet.tiles.values()
        ]
        said = sorted(self._last.values(), key=lambda event: event["time"])
        looked = self.look(now_s)
        self._shown = shown
        # A port that has closed is told after what its tile has said: it says so no more.
        return [classes_event(time_s, self.told_looks()), *said, *ports, *looked, *self._notes]


def _display(view: TileView) -> tuple[int, tuple[int, int, int], str]:
    """What a tile's display must look like, by what it says: real ones do not tell it."""
    if view.tile is None or not view.is_open or view.tile.class_index is None:
        return (0, (0, 0, 0), view.tile.links if view.tile and view.is_open else NO_LINKS)
    look = look_of(view.tile.label, view.tile.class_index)
    return (look.segments, look.colour, view.tile.links)
