"""Events on their way to one client: the latest of each kind and tile, however slow the client is."""

from collections.abc import Iterable

from tilenca.protocol.sentences import LinkSentence, parse_sentence, type_of
from tilenca.protocol.stream import StreamEvent

# Of those each one counts; so many wait, and older ones give way.
MOST_FRAMES = 256
MOST_REFUSALS = 8
MOST_DEEDS = 256
MOST_NOTES = 64
BOUNDED = {"frame": MOST_FRAMES, "refused": MOST_REFUSALS, "deed": MOST_DEEDS, "note": MOST_NOTES}
# Batches that may be on their way, unseen.
MOST_UNSEEN = 3


class Outbox:
    """Holds what the client has not got yet, and no more than one event for each thing that it can know."""

    def __init__(self) -> None:
        self._waiting: dict[tuple[object, ...], StreamEvent] = {}
        self._counters: dict[str, int] = dict.fromkeys(BOUNDED, 0)
        self._sent = self._seen = 0

    def put(self, events: Iterable[StreamEvent]) -> None:
        """Adds events, in their order; a newer one replaces the older one of the same thing."""
        for event in events:
            if "run" in event or "jump" in event:  # all before it is void
                stays = ("stream", "refused") if "run" in event else ("stream", "refused", "run", "deed")
                self._waiting = {key: old for key, old in self._waiting.items() if key[0] in stays}
            key = self._key(event)
            self._waiting.pop(key, None)
            self._waiting[key] = event

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
        events = list(self._waiting.values())
        self._waiting = {}
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
