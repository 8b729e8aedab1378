"""Events on their way to one client: the latest of each kind and tile, however slow the client is.

What a tile shows is counted on the page: of that each change comes, and not the latest only.
"""

from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

from tilenca.protocol.sentences import HelloSentence, LinkSentence, TileSentence, parse_sentence, type_of
from tilenca.protocol.stream import StreamEvent

# Of those each one counts; so many wait, and older ones give way.
MOST_FRAMES = 256
MOST_REFUSALS = 8
MOST_DEEDS = 256
MOST_NOTES = 64
# After these a tile shows another label than before; beyond so many the oldest are left out.
MOST_CHANGES = 4096
BOUNDED = {"frame": MOST_FRAMES, "refused": MOST_REFUSALS, "deed": MOST_DEEDS, "note": MOST_NOTES}
# Batches that may be on their way, unseen.
MOST_UNSEEN = 3


class _Waiting(NamedTuple):
    """An event that the client has not got, and its number among all."""

    number: int
    event: StreamEvent
    is_change: bool


class Outbox:
    """Holds what the client has not got yet: one of each thing, and of labels all changes."""

    def __init__(self) -> None:
        self._waiting: dict[tuple[object, ...], _Waiting] = {}
        self._changes: deque[_Waiting] = deque(maxlen=MOST_CHANGES)
        self._labels: dict[object, str] = {}
        self._put = 0
        self._counters: dict[str, int] = dict.fromkeys(BOUNDED, 0)
        self._sent = self._seen = 0

    def put(self, events: Iterable[StreamEvent]) -> None:
        """Adds events, in their order; a newer one replaces the older one of the same thing.

        An older one after which its tile showed another label waits on.
        """
        for event in events:
            if "run" in event or "jump" in event:  # all before it is void
                stays = ("stream", "refused") if "run" in event else ("stream", "refused", "run", "deed")
                self._waiting = {key: old for key, old in self._waiting.items() if key[0] in stays}
                self._changes.clear()
                self._labels.clear()
            key = self._key(event)
            older = self._waiting.pop(key, None)
            if older is not None and older.is_change:
                self._changes.append(older)
            self._put += 1
            self._waiting[key] = _Waiting(self._put, event, self._changes_label(event))

    def _changes_label(self, event: StreamEvent) -> bool:
        """Whether the page shows another label of the tile after it: as `show` of page/stream/tiles.js."""
        port = event.get("port")
        before = self._labels.get(port, "")
        label = before
        if "raw" in event:
            sentence = parse_sentence(str(event["raw"]))
            if isinstance(sentence, TileSentence):
                label = sentence.label
            elif isinstance(sentence, HelloSentence) and not event.get("asked"):
                label = ""
        elif event.get("open", True) is False or event.get("place", ()) is None:
            label = ""
        self._labels[port] = label
        return label != before

    def _key(self, event: StreamEvent) -> tuple[object, ...]:
        port = event.get("port")
        for kind, most in BOUNDED.items():
            if kind in event:
                self._counters[kind] += 1
                return kind, self._counters[kind] % most
        if "raw" in event:
            return "raw", port, *subject_of(str(event["raw"]))
        for kind in ("stream", "run", "jump", "pace", "classes"):
            if kind in event:
                return (kind,)
        return (
            next(
                key
                for key in ("place", "cable", "open", "display", "health", "fault", "chip")
                if key in event
            ),
            port,
            event.get("side"),
        )

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return not self._waiting

    @property
    def may_send(self) -> bool:
        """Whether something waits, and the client has seen most of what it got."""
        return bool(self._waiting) and self._sent - self._seen < MOST_UNSEEN

    def take(self) -> tuple[int, list[StreamEvent]]:
        """The next batch: its number, counted from 1, and its events in order of time."""
        self._sent += 1
        events = [one.event for one in sorted([*self._changes, *self._waiting.values()])]
        self._waiting = {}
        self._changes.clear()
        return self._sent, events

    def seen(self, batch: int) -> None:
        """The client has shown a batch and all before it; a number that was not sent counts for nothing."""
        if self._seen < batch <= self._sent:
            self._seen = batch


def subject_of(raw: str) -> tuple[str, str]:
    """The name of a sentence, and the side of a `$LINK`; one subject for all lines that are no sentence."""
    sentence = parse_sentence(raw)
    if isinstance(sentence, LinkSentence):
        return "LINK", sentence.side
    return ("" if sentence is None else type_of(sentence)), ""
