"""What the page is told of a board: all that is news, and after a jump in time all that there is."""

import copy
from dataclasses import dataclass, field

from tilenca.base.sides import SIDES
from tilenca.emulator.arrangement import Arrangement, Place
from tilenca.emulator.array import Array, Link
from tilenca.emulator.telemetry import heard_from
from tilenca.emulator.types import port_index, port_name
from tilenca.page.outbox import subject_of
from tilenca.protocol.line_reader import LineReader
from tilenca.protocol.stream import (
    StreamEvent,
    cable_event,
    display_event,
    fault_event,
    frame_event,
    open_event,
    place_event,
    raw_event,
)

NO_POWER = "no power"
RESTARTED = "it starts anew"
# What a copy of a voice takes, measured.
VOICE_BYTES = 600


@dataclass
class _Seen:
    """What the page has been told of one tile."""

    place: Place | None = None
    powered: bool | None = None
    started_s: float | None = None
    display: tuple[int, tuple[int, ...], str] | None = None
    fault: tuple[bool, float] = (False, 0.0)


@dataclass
class Voice:
    """What a tile has said: the beginning of its next line, and its last line of each kind."""

    reader: LineReader = field(default_factory=LineReader)
    last: dict[tuple[str, str], StreamEvent] = field(default_factory=dict)

    def copied(self) -> "Voice":
        """Another one of its own; nobody changes an event, so that they are shared."""
        return Voice(copy.copy(self.reader), dict(self.last))


# What a board has said, to be kept with a moment of it.
Said = list[Voice]


class Teller:
    """Looks at a board, and tells the page."""

    def __init__(self, array: Array, board: Arrangement) -> None:
        self._array, self._board = array, board
        self._seen: list[_Seen] = []
        self._seen_cut: set[Link] = set()
        self._voices: Said = []

    def places(self) -> list[StreamEvent]:
        """What lies where, has power, shines and is joined, as far as it is news."""
        events: list[StreamEvent] = []
        now_s = self._array.time_s
        while len(self._seen) < len(self._array):
            self._seen.append(_Seen())
        while len(self._voices) < len(self._array):
            self._voices.append(Voice())
        for tile, seen in zip(self._array, self._seen, strict=True):
            port, place = port_name(tile.index), self._board.places.get(tile.index)
            if place != seen.place:
                seen.place = place
                events.append(place_event(now_s, port, place))
            started_s = self._board.started_s(tile.index)
            is_anew = seen.started_s not in (None, started_s)
            seen.started_s = started_s
            if place is not None and tile.powered and seen.powered and is_anew:
                seen.powered = False  # what it showed is over
                events.append(open_event(now_s, port, False, RESTARTED))
            if place is not None and tile.powered != seen.powered:
                seen.powered = tile.powered
                events.append(open_event(now_s, port, tile.powered, "" if tile.powered else NO_POWER))
            if (fault := self._board.fault_of(tile.index)) != seen.fault:
                seen.fault = fault
                events.append(fault_event(now_s, port, *fault))
            leds = "".join(name if lit else "-" for name, lit in zip(SIDES, tile.leds, strict=True))
            if (display := (tile.segments, tile.rgb, leds)) != seen.display:
                seen.display = display
                events.append(display_event(now_s, port, *display))
        cut = self._board.cut
        for link in sorted(cut ^ self._seen_cut):
            events.append(cable_event(now_s, port_name(link[0]), SIDES[link[1]], link not in cut))
        self._seen_cut = cut
        return events

    def look(self, frames: bool) -> list[StreamEvent]:
        """All that is news; with `frames`, the frames on the cables, too."""
        events = self.places()
        passed = self._board.traffic.read()
        if frames:
            events += [
                frame_event(frame.time_s, port_name(frame.tile), SIDES[frame.side], frame.data)
                for frame in passed
            ]
        lines = self._lines()
        old = [event for event in lines if self._is_over(event)]
        return [*old, *events, *(event for event in lines if not self._is_over(event))]

    def _is_over(self, said: StreamEvent) -> bool:
        """Whether a line tells what a tile showed before it was switched on or reset last."""
        if not said["raw"].startswith("$TILE,"):
            return False
        time_s: float = said["time"]
        return time_s <= self._board.started_s(port_index(said["port"]))

    def _lines(self) -> list[StreamEvent]:
        said = []
        for tile, voice in zip(self._array, self._voices, strict=True):
            for line in heard_from(tile, voice.reader):
                event = raw_event(line.time_s, line.port, line.raw)
                voice.last[subject_of(event["raw"])] = event
                said.append((line.time_s, line.port, event))
        return [event for _, _, event in sorted(said, key=lambda one: one[:2])]

    # --- moments ---

    def save(self) -> Said:
        """What the tiles have said until now."""
        return [voice.copied() for voice in self._voices]

    def restore(self, said: Said) -> None:
        """The board has gone to the moment of a `save`: forgets what the page knows."""
        for tile in self._array:
            tile.read_serial()  # of the future that is left
        self._voices = [voice.copied() for voice in said]
        self._seen, self._seen_cut = [], set()

    def all(self) -> list[StreamEvent]:
        """Everything, for a page that knows nothing; lines have the times at which they were said."""
        self._seen, self._seen_cut = [], set()
        self.look(frames=False)
        last = (event for voice in self._voices for event in voice.last.values())
        said = sorted((event for event in last if not self._is_over(event)), key=_moment)
        self._seen, self._seen_cut = [], set()
        return [*self.places(), *said, *self.look(frames=False)]


def _moment(event: StreamEvent) -> tuple[float, str]:
    return event["time"], event["port"]
