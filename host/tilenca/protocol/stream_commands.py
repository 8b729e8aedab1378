"""The commands of a page to what runs the tiles (docs/PROTOCOL.md section 7): checked and bounded."""

import json
from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, TypeAlias

from tilenca.base.sides import SIDES

MAX_TEXT = 16_384  # characters of a command
MAX_PLACE = 64  # rows and columns are -MAX_PLACE..MAX_PLACE
MOST_TILES = 144
MOST_FAULTS = 32
MAX_NAME = 64
MAX_SPEED = 1024.0
MIN_SPEED = 1e-5
MAX_SECONDS = 86_400.0
MAX_SEED = 2**53 - 1  # whole numbers of JavaScript

Check: TypeAlias = Callable[[object], Any]


def _whole(low: int, high: int) -> Check:
    def check(value: object) -> int:
        if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
            raise ValueError(f"must be a whole number in {low}..{high}")
        return value

    return check


def _number(low: float, high: float, or_zero: bool = False) -> Check:
    def check(value: object) -> float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not (low <= value <= high or (or_zero and value == 0)):  # type: ignore[operator]
            raise ValueError(f"must be a number in {low:g}..{high:g}{' or 0' if or_zero else ''}")
        return float(value)  # type: ignore[arg-type]

    return check


def _switch(value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError("must be true or false")
    return value


def _text(value: object) -> str:
    if not isinstance(value, str) or not 0 < len(value) <= MAX_NAME or not value.isprintable():
        raise ValueError(f"must be a text of 1 to {MAX_NAME} characters")
    return value


def _side(value: object) -> str:
    if not isinstance(value, str) or len(value) != 1 or value not in SIDES:
        raise ValueError(f"must be one of {', '.join(SIDES)}")
    return value


def _list(most: int, check: Check, what: str) -> Check:
    def check_all(value: object) -> tuple[Any, ...]:
        if not isinstance(value, list) or len(value) > most:
            raise ValueError(f"must be a list of at most {most} {what}")
        return tuple(check(item) for item in value)

    return check_all


_place = _whole(-MAX_PLACE, MAX_PLACE)


def _cell(value: object) -> tuple[int, int]:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError("must be places, [row, column] each")
    return _place(value[0]), _place(value[1])


def _cells(value: object) -> tuple[tuple[int, int], ...]:
    cells: tuple[tuple[int, int], ...] = _list(MOST_TILES, _cell, "places")(value)
    if not cells or len(set(cells)) != len(cells):
        raise ValueError(f"must be 1 to {MOST_TILES} different places")
    return cells


def _or_none(check: Check) -> Check:
    return lambda value: None if value is None else check(value)


def _checked(check: Check, default: object = MISSING) -> Any:
    if default is MISSING:
        return field(metadata={"check": check})
    return field(default=default, metadata={"check": check})


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
    """

    cells: tuple[tuple[int, int], ...] = _checked(_cells)
    seed: int = _checked(_whole(0, MAX_SEED), 0)
    faults: tuple[str, ...] = _checked(_list(MOST_FAULTS, _text, "faults"), ())
    spread_s: float = _checked(_number(0, 3600), 1.0)
    speed: float = _checked(_number(MIN_SPEED, MAX_SPEED, or_zero=True), 1.0)
    paused: bool = _checked(_switch, False)
    until_s: float | None = _checked(_or_none(_number(0, MAX_SECONDS)), None)


@dataclass(frozen=True)
class Pace:
    """Time passes at `speed` times real time; 0: as fast as it can."""

    speed: float = _checked(_number(MIN_SPEED, MAX_SPEED, or_zero=True))
    paused: bool = _checked(_switch, False)


@dataclass(frozen=True)
class Rest:
    """Nobody looks (or somebody does again): time stands still, whatever the pace."""

    on: bool = _checked(_switch)


@dataclass(frozen=True)
class Step:
    """Runs so many seconds, while paused."""

    seconds: float = _checked(_number(16e-6, 10))


@dataclass(frozen=True)
class Seek:
    """Goes to a time that the run has been at, and pauses there."""

    seconds: float = _checked(_number(0, MAX_SECONDS))


@dataclass(frozen=True)
class Put:
    """Plugs a tile in at an empty place; it boots."""

    row: int = _checked(_place)
    col: int = _checked(_place)


@dataclass(frozen=True)
class Pull:
    """Takes a tile away."""

    port: str = _checked(_text)


@dataclass(frozen=True)
class Move:
    """Takes a tile out and plugs it in at another place, where it boots."""

    port: str = _checked(_text)
    row: int = _checked(_place)
    col: int = _checked(_place)


@dataclass(frozen=True)
class Arrange:
    """Makes another drawing of the running tiles: those that lie in both stay and keep their state."""

    cells: tuple[tuple[int, int], ...] = _checked(_cells)


@dataclass(frozen=True)
class Cut:
    """Cuts the cable at a side of a tile, or mends it."""

    port: str = _checked(_text)
    side: str = _checked(_side)
    on: bool = _checked(_switch, True)


@dataclass(frozen=True)
class Power:
    """Takes a tile's power, or gives it back; it keeps its place."""

    port: str = _checked(_text)
    on: bool = _checked(_switch)


@dataclass(frozen=True)
class Freeze:
    """Stops a tile's updates; it goes on saying its last state. Or lets it update again."""

    port: str = _checked(_text)
    on: bool = _checked(_switch, True)


@dataclass(frozen=True)
class Reset:
    """Resets a tile."""

    port: str = _checked(_text)


@dataclass(frozen=True)
class Noise:
    """From now on this share of the bytes on all cables is lost."""

    loss: float = _checked(_number(0, 1))


@dataclass(frozen=True)
class Seen:
    """The page has shown this batch: the next one may come."""

    batch: int = _checked(_whole(0, MAX_SEED))


StreamCommand: TypeAlias = (
    Open
    | Pace
    | Rest
    | Step
    | Seek
    | Put
    | Pull
    | Move
    | Arrange
    | Cut
    | Power
    | Freeze
    | Reset
    | Noise
    | Seen
)
KINDS: dict[str, type[Any]] = {
    kind.__name__.lower(): kind
    for kind in (
        Open, Pace, Rest, Step, Seek, Put, Pull, Move, Arrange, Cut, Power, Freeze, Reset, Noise, Seen,
    )
}  # fmt: skip


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
    command: StreamCommand = kind(**given)
    return command
