"""The stream of tile events (docs/PROTOCOL.md section 7): JSON objects, in recordings and on the page.

Ports name tiles. Times are in seconds: since 1970 from real tiles, since the run began from emulated ones.
"""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

STREAM_VERSION = 1
# Every byte is a character of Latin-1 and back.
RAW_ENCODING = "latin-1"
MOST_REFUSAL = 300  # characters

StreamEvent: TypeAlias = dict[str, Any]

# What an event is about; each has exactly one of these keys.
KINDS = (
    "stream",
    "run",
    "jump",
    "pace",
    "place",
    "cable",
    "fault",
    "chip",
    "raw",
    "open",
    "deed",
    "display",
    "frame",
    "classes",
    "health",
    "note",
    "refused",
)


def _event(time_s: float, **about: object) -> StreamEvent:
    return {"time": round(time_s, 6), **about}


def stream_event(source: str, **about: object) -> StreamEvent:
    """The first one: the version, what the tiles are (`emulated`), and what a page can do with them."""
    return {"time": 0.0, "stream": STREAM_VERSION, "source": source, **about}


def run_event(time_s: float, about: Mapping[str, object]) -> StreamEvent:
    """A run begins: all that was known of tiles is void."""
    return _event(time_s, run=dict(about))


def jump_event(time_s: float, from_s: float, forget: bool = False) -> StreamEvent:
    """The run has gone to another of its moments: what was known of tiles is void, and told anew.

    Args:
        time_s: of that moment.
        from_s: the time before.
        forget: what hands did later is taken back.
    """
    return _event(time_s, jump={"from": round(from_s, 6), **({"forget": True} if forget else {})})


def pace_event(time_s: float, speed: float, paused: bool, share: float, end_s: float | None) -> StreamEvent:
    """How time passes: `speed` times real time (0: as fast as it can), of which `share` (0..1) is reached.

    One can go to every time up to `end_s`; nowhere where it is None.
    """
    end = {} if end_s is None else {"end": round(end_s, 6)}
    return _event(time_s, pace={"speed": speed, "paused": paused, "share": round(share, 3), **end})


def place_event(
    time_s: float, port: str, place: tuple[int, int] | None, tile: int | None = None
) -> StreamEvent:
    """A tile lies at (row, column) from now on; None: it was taken away.

    `tile` is its id, where the name of its port does not tell it.
    """
    number = {} if tile is None else {"tile": tile}
    return _event(time_s, port=port, place=None if place is None else list(place), **number)


def classes_event(time_s: float, looks: Sequence[Mapping[str, object]]) -> StreamEvent:
    """What the tiles can show, from now on: label, segments and RGB duty of each class."""
    return _event(time_s, classes=list(looks))


def health_event(
    time_s: float, port: str, trouble: str, links: Mapping[str, tuple[str, float | None]]
) -> StreamEvent:
    """How a tile is.

    Args:
        time_s: of the stream.
        port: the tile.
        trouble: one word, or "".
        links: of each side how its link is, and the share (0..1) of frames that arrive whole.
    """
    about = {side: [mark, None if good is None else round(good, 2)] for side, (mark, good) in links.items()}
    return _event(time_s, port=port, health={"trouble": trouble, "links": about})


def note_event(time_s: float, port: str, text: str, bad: bool) -> StreamEvent:
    """A line of the log: what has changed, and whether a person should look."""
    return _event(time_s, port=port, note=text, bad=bad)


def cable_event(time_s: float, port: str, side: str, whole: bool) -> StreamEvent:
    """The cable at a side is cut, or whole again; of the tile that is west or north of it."""
    return _event(time_s, port=port, side=side, cable="whole" if whole else "cut")


def fault_event(time_s: float, port: str, turned: bool, skew: float) -> StreamEvent:
    """How a tile is spoilt from now on: whether it lies turned, and by how many ppm its clock is too fast."""
    return _event(time_s, port=port, fault={"turned": turned, "skew": round(skew, 3)})


def chip_event(time_s: float, port: str, chip: Mapping[str, object]) -> StreamEvent:
    """What is in a tile's chip, between two of its instructions."""
    return _event(time_s, port=port, chip=dict(chip))


def deed_event(time_s: float, command: Mapping[str, object]) -> StreamEvent:
    """A hand does this at that time; all that it would have done later is void."""
    return _event(time_s, deed=dict(command))


def raw_event(time_s: float, port: str, raw: bytes) -> StreamEvent:
    """One line that a tile has said, without its end."""
    return _event(time_s, port=port, raw=raw.decode(RAW_ENCODING))


def open_event(time_s: float, port: str, is_open: bool, reason: str) -> StreamEvent:
    """A port was opened or has closed; an emulated tile's closes while it has no power."""
    return _event(time_s, port=port, open=is_open, reason=reason)


def display_event(time_s: float, port: str, segments: int, rgb: Sequence[int], leds: str) -> StreamEvent:
    """The levels of the display's pins: lit segments, duties 0..255, lamps that are lit (`NESW` or `-`)."""
    return _event(time_s, port=port, display={"segments": segments, "rgb": list(rgb), "leds": leds})


def frame_event(time_s: float, port: str, side: str, data: bytes) -> StreamEvent:
    """A frame has left a tile on that side; its bytes as on the cable, without the delimiter."""
    return _event(time_s, port=port, side=side, frame=data.hex())


def refused_event(time_s: float, reason: str) -> StreamEvent:
    """A command was not carried out; the reason is cut where it is long."""
    return _event(time_s, refused=reason[:MOST_REFUSAL])
