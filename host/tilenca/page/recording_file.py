"""The file of a recording of the page (docs/PROTOCOL.md section 7), checked as the page checks it.

The twin of `page/stream/recording_file.js`: `test/page/test_recording_file.py` asks both.
"""

import re
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeAlias

from tilenca.base.errors import UsageError
from tilenca.base.parsing import read_json
from tilenca.base.sides import SIDES
from tilenca.base.stdio import warn
from tilenca.protocol.stream import STREAM_VERSION

MOST_EVENTS = 2_000_000
LONGEST_S = 1e7
MOST_PLACE = 1000
MOST_PERIOD_MS = 60_000
MOST_TEXT = MOST_LIST = 4096
MOST_SEED = 2**53 - 1
BLANK = " \t\r\n"
BEGINNING = 2  # lines that each one has
CHOOSE = "give a recording of the page or of --record"
_HEX = re.compile(r"([0-9a-fA-F]{2})*")

Check: TypeAlias = Callable[[Any, dict[str, Any]], bool]


def _is_in(value: object, low: float, high: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high


def _is_whole(value: Any, low: float, high: float) -> bool:
    return _is_in(value, low, high) and value == int(value)


def _is_text(value: object) -> bool:
    # JavaScript counts a character beyond the first plane twice.
    return isinstance(value, str) and sum(1 + (one > "\uffff") for one in value) <= MOST_TEXT


def _is_colour(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(_is_whole(part, 0, 255) for part in value)


def _is_side(value: object) -> bool:
    return isinstance(value, str) and value in tuple(SIDES)


def _is_look(look: object) -> bool:
    match look:
        case {"label": label, "segments": segments, "rgb": rgb}:
            return _is_text(label) and _is_whole(segments, 0, 255) and _is_colour(rgb)
    return False


def _is_list_of(value: object, check: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and len(value) <= MOST_LIST and all(map(check, value))


def _is_drawing(drawing: object) -> bool:
    match drawing:
        case {"name": name, "label": label, "rows": rows}:
            return _is_text(name) and _is_text(label) and _is_list_of(rows, _is_text) and rows != []
    return False


def _is_model(model: object) -> bool:
    match model:
        case {"name": name, "id": model_id, "labels": labels}:
            return _is_text(name) and _is_text(model_id) and _is_list_of(labels, _is_text)
    return False


def _is_stream(event: dict[str, Any]) -> bool:
    """Of the first event."""
    lists = (("models", _is_model), ("looks", _is_look), ("drawings", _is_drawing))
    return (
        all(_is_text(text) for text in (event.get("source"), event.get("of", ""), event.get("model", "")))
        and all(_is_list_of(event.get(name, []), check) for name, check in lists)
        and _is_whole(event.get("most_tiles", 0), 0, MOST_PLACE**2)
        and _is_whole(event.get("most_place", 0), 0, MOST_PLACE)
        and _is_in(_given(event, "period_ms", 1), 1, MOST_PERIOD_MS)
    )


def _given(about: dict[str, Any], name: str, otherwise: Any) -> Any:
    """A value, or another where there is none or null."""
    value = about.get(name)
    return otherwise if value is None else value


def _is_link(link: object) -> bool:
    match link:
        case [text, share]:
            return _is_text(text) and (share is None or _is_in(share, 0, 1))
    return False


def _is_display(show: Any, event: dict[str, Any]) -> bool:
    match show:
        case {"segments": segments, "rgb": rgb, "leds": leds}:
            return (
                _is_whole(segments, 0, 255) and _is_colour(rgb) and isinstance(leds, str) and len(leds) == 4
            )
    return False


def _is_health(health: Any, event: dict[str, Any]) -> bool:
    match health:
        case {"trouble": trouble, "links": dict(links)}:
            return _is_text(trouble) and all(
                _is_side(side) and _is_link(link) for side, link in links.items()
            )
    return False


def _is_place(place: Any, event: dict[str, Any]) -> bool:
    return place is None or (
        _is_list_of(place, lambda one: _is_whole(one, -MOST_PLACE, MOST_PLACE)) and len(place) == 2
    )


def _is_fault(fault: Any, event: dict[str, Any]) -> bool:
    return (
        isinstance(fault, dict)
        and isinstance(fault.get("turned"), bool)
        and _is_in(fault.get("skew"), -1e6, 1e6)
    )


def _is_run(run: Any, event: dict[str, Any]) -> bool:
    return (
        isinstance(run, dict)
        and _is_in(run.get("seed"), 0, MOST_SEED)
        and _is_in(_given(run, "began", 0), 0, 1e12)
    )


def _is_pace(pace: Any, event: dict[str, Any]) -> bool:
    return (
        isinstance(pace, dict)
        and _is_in(pace.get("speed"), 0, 1024)
        and _is_in(_given(pace, "end", 0), 0, LONGEST_S)
    )


def _is_plain(value: object) -> bool:
    return (
        value is None
        or _is_in(value, -sys.float_info.max, sys.float_info.max)
        or (isinstance(value, bool) or _is_text(value))
    )


def _is_deed(deed: Any, event: dict[str, Any]) -> bool:
    """Given plain values, lists of them, and lists of such lists."""
    return (
        isinstance(deed, dict)
        and _is_text(deed.get("do"))
        and all(
            _is_plain(value) or _is_list_of(value, lambda one: _is_plain(one) or _is_list_of(one, _is_plain))
            for value in deed.values()
        )
    )


# What each subject must be, and which of them are about a tile.
SUBJECTS: dict[str, tuple[Check, bool]] = {
    "stream": (lambda _, event: _is_stream(event), False),
    "run": (_is_run, False),
    "jump": (lambda jump, _: isinstance(jump, dict) and _is_in(jump.get("from"), 0, LONGEST_S), False),
    "pace": (_is_pace, False),
    "deed": (_is_deed, False),
    "classes": (lambda looks, _: _is_list_of(looks, _is_look), False),
    "refused": (lambda text, _: _is_text(text), False),
    "place": (_is_place, True),
    "cable": (lambda cable, event: cable in ("cut", "whole") and _is_side(event.get("side")), True),
    "fault": (_is_fault, True),
    "raw": (lambda text, _: _is_text(text), True),
    "open": (
        lambda is_open, event: isinstance(is_open, bool) and _is_text(_given(event, "reason", "")),
        True,
    ),
    "display": (_is_display, True),
    "frame": (
        lambda frame, event: _is_text(frame) and bool(_HEX.fullmatch(frame)) and _is_side(event.get("side")),
        True,
    ),
    "health": (_is_health, True),
    "note": (lambda text, _: _is_text(text), True),
}


def wrong_with(event: Any) -> str:
    """What is wrong with an event; "" for nothing."""
    if not isinstance(event, dict) or not _is_in(event.get("time"), 0, LONGEST_S):
        return "is no event"
    subjects = [name for name in SUBJECTS if name in event]
    if len(subjects) > 1:
        return f"tells of {' and '.join(subjects)} at once"
    if not subjects:
        return ""  # of a later version: the page passes over it
    (name,) = subjects
    check, is_of_tile = SUBJECTS[name]
    if is_of_tile and not (_is_text(event.get("port")) and event["port"]):
        return f"tells of a {name}, and not of which tile"
    return "" if check(event[name], event) else f"tells of a {name} that cannot be"


def check_recording(path: Path, lines: Iterable[str]) -> str:
    """A recording of the page, without a last line that was cut off.

    Args:
        path: for messages.
        lines: of the file, with their ends.

    Raises:
        UsageError: the page would not show it.
    """
    kept: list[str] = []
    events = 0
    for number, line in enumerate(lines, start=1):
        if line.strip(BLANK):
            event = _parsed(line)
            if event is None and not line.endswith("\n") and number > BEGINNING:
                warn(f"{path}:{number}: cut off in its middle; the recording ends before it")
                break
            if wrong := _other_version(event, events) or wrong_with(event) or _misplaced(event, events):
                raise UsageError(f"{path}:{number}: {wrong}; {CHOOSE}")
            events += 1
            if events > MOST_EVENTS:
                raise UsageError(f"{path}: it has more than {MOST_EVENTS} events; record a shorter run")
        kept.append(line)
    if events < BEGINNING:
        raise UsageError(f"{path}: it does not begin as a recording of the page does; {CHOOSE}")
    return "".join(kept)


def _other_version(event: Any, before: int) -> str:
    """Which version of the stream a first event tells of; "" for this one."""
    version = event.get("stream", STREAM_VERSION) if isinstance(event, dict) else STREAM_VERSION
    if before or (version == STREAM_VERSION and version is not True):
        return ""
    return f"it has version {version} of the stream, tilenca has {STREAM_VERSION}"


def _misplaced(event: dict[str, Any], before: int) -> str:
    """Why an event cannot come after so many; "" where it can."""
    begins = ("stream", "run")
    if before < BEGINNING:
        return "" if begins[before] in event else "it does not begin as a recording of the page does"
    return "it has more than one run" if any(name in event for name in begins) else ""


def _parsed(line: str) -> Any:
    try:
        return read_json(line, parse_constant=_no_number)
    except ValueError:
        return None


def _no_number(name: str) -> None:
    raise ValueError(f"{name} is no number of JSON")
