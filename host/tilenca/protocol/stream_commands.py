"""The commands of a page to what runs the tiles (docs/PROTOCOL.md section 7): checked and bounded."""

import json
from dataclasses import MISSING, dataclass, fields
from typing import Any, TypeAlias, get_args

from tilenca.protocol import stream_fields as must_be
from tilenca.protocol.constants import SETTING_RANGES
from tilenca.protocol.stream_fields import MAX_NAME, checked
from tilenca.protocol.stream_hands import HANDS, Hand, Set

MAX_TEXT = 16_384  # characters of a command
MOST_FAULTS, MOST_DEEDS = 32, 200
MIN_SPEED, MAX_SPEED = 1e-5, 1024.0
MAX_SECONDS = 86_400.0
MOST_INSTRUCTIONS = 1000
MAX_SEED = 2**53 - 1  # whole numbers of JavaScript


def _deed(value: object) -> "Deed":
    if not isinstance(value, list) or len(value) != 2 or not isinstance(value[1], dict):
        raise ValueError("must be deeds, [seconds, command] each")
    time_s: float = must_be.number(0, MAX_SECONDS)(value[0])
    name = value[1].get("do")
    if isinstance(name, str) and name in KINDS and KINDS[name] not in HANDS:  # before its own deeds are read
        raise ValueError(f"must be commands that change something, and {name} does not")
    command = _read(dict(value[1]))
    assert isinstance(command, HANDS)
    hand: Hand = command
    return time_s, hand


def _deeds(value: object) -> tuple["Deed", ...]:
    deeds = must_be.list_of(MOST_DEEDS, _deed, "deeds")(value)
    return tuple(sorted(deeds, key=lambda deed: deed[0]))


@dataclass(frozen=True)
class Open:
    """Begins a run from power-on.

    Attributes:
        cells: places of the tiles, in any order; tiles are numbered in reading order.
        seed: decides clock errors, switch-on times and chance.
        faults: as of `tilenca emulate --fault`.
        spread_s: tiles are switched on within so many seconds.
        speed: see `Pace`.
        paused: whether it begins paused.
        until_s: the time at which it pauses by itself; None: never.
        deeds: what hands do, and when, in order of time.
    """

    cells: tuple[tuple[int, int], ...] = checked(must_be.cells)
    seed: int = checked(must_be.whole(0, MAX_SEED), 0)
    faults: tuple[str, ...] = checked(must_be.list_of(MOST_FAULTS, must_be.text, "faults"), ())
    spread_s: float = checked(must_be.number(0, 3600), 1.0)
    speed: float = checked(must_be.number(MIN_SPEED, MAX_SPEED, or_zero=True), 1.0)
    paused: bool = checked(must_be.switch, False)
    until_s: float | None = checked(must_be.or_none(must_be.number(0, MAX_SECONDS)), None)
    deeds: tuple["Deed", ...] = checked(_deeds, ())


@dataclass(frozen=True)
class Pace:
    """Time passes at `speed` times real time; 0: as fast as it can."""

    speed: float = checked(must_be.number(MIN_SPEED, MAX_SPEED, or_zero=True))
    paused: bool = checked(must_be.switch, False)


@dataclass(frozen=True)
class Rest:
    """Nobody looks (or somebody does again): time stands still, whatever the pace."""

    on: bool = checked(must_be.switch)


@dataclass(frozen=True)
class Step:
    """Runs so many seconds, while paused."""

    seconds: float = checked(must_be.number(16e-6, 10))


@dataclass(frozen=True)
class Seek:
    """Goes to a time that the run has been at, and pauses there; `forget` takes later deeds back."""

    seconds: float = checked(must_be.number(0, MAX_SECONDS))
    forget: bool = checked(must_be.switch, False)


@dataclass(frozen=True)
class Instruct:
    """Executes so many instructions of a tile, while paused, and tells what is in its chip."""

    port: str = checked(must_be.text)
    count: int = checked(must_be.whole(0, MOST_INSTRUCTIONS), 1)


@dataclass(frozen=True)
class Seen:
    """The page has shown this batch: the next one may come."""

    batch: int = checked(must_be.whole(0, MAX_SEED))


Deed: TypeAlias = tuple[float, Hand]

StreamCommand: TypeAlias = Open | Pace | Rest | Step | Seek | Instruct | Hand | Seen
KINDS: dict[str, type[Any]] = {kind.__name__.lower(): kind for kind in get_args(StreamCommand)}


def _refuse_constant(text: str) -> float:
    raise ValueError(f"{text} is no number")


def parse_command(text: str) -> StreamCommand:
    """The command in a JSON object.

    Raises:
        ValueError: it is none; in words that a person understands.
    """
    if len(text) > MAX_TEXT:
        raise ValueError(f"a command has at most {MAX_TEXT} characters")
    try:
        about = json.loads(text, parse_constant=_refuse_constant)
    except RecursionError:
        raise ValueError("lists lie too deep in each other") from None
    except ValueError as error:
        raise ValueError(f"not JSON: {error}") from None
    if not isinstance(about, dict):
        raise ValueError("a command is an object")
    return _read(about)


def told(command: Hand) -> dict[str, Any]:
    """The command as JSON has it, with all its fields."""
    values = {one.name: getattr(command, one.name) for one in fields(command)}
    return {"do": type(command).__name__.lower(), **json.loads(json.dumps(values))}


def _read(about: dict[str, Any]) -> StreamCommand:
    name = about.pop("do", None)
    if not isinstance(name, str) or name not in KINDS:
        raise ValueError(f'a command has "do", one of: {", ".join(KINDS)}')
    kind = KINDS[name]
    given: dict[str, Any] = {}
    for one in fields(kind):
        if one.name in about:
            try:
                given[one.name] = one.metadata["check"](about.pop(one.name))
            except ValueError as error:
                raise ValueError(f"{name}: {one.name} {error}") from None
        elif one.default is MISSING:
            raise ValueError(f"{name}: {one.name} is missing")
    if about:
        raise ValueError(f"{name}: it has no {str(next(iter(about)))[:MAX_NAME]!r}")
    if kind is Set:
        try:
            must_be.whole(*SETTING_RANGES[given["name"]])(given["value"])
        except ValueError as error:
            raise ValueError(f"{name}: value {error}") from None
    command: StreamCommand = kind(**given)
    return command
