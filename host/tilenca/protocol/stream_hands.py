"""What a hand does to tiles, as commands of a page (docs/PROTOCOL.md section 7); see `stream_commands`."""

from dataclasses import dataclass
from typing import Any, TypeAlias, get_args

from tilenca.protocol import stream_fields as must_be
from tilenca.protocol.constants import MAX_BLINK_S
from tilenca.protocol.stream_fields import MAX_PLACE, MOST_TILES, checked

MAX_SKEW_PPM = 100_000
SETTINGS = ("period", "updates", "brightness")  # an id is nothing to change in passing


@dataclass(frozen=True)
class Put:
    """Plugs a tile in at an empty place; it boots."""

    row: int = checked(must_be.place)
    col: int = checked(must_be.place)


@dataclass(frozen=True)
class Pull:
    """Takes a tile away."""

    port: str = checked(must_be.text)


@dataclass(frozen=True)
class Move:
    """Takes a tile out and plugs it in at another place, where it boots."""

    port: str = checked(must_be.text)
    row: int = checked(must_be.place)
    col: int = checked(must_be.place)


@dataclass(frozen=True)
class Shift:
    """Moves tiles by so many places; they run on, and the cables between them stay plugged in."""

    ports: tuple[str, ...] = checked(must_be.list_of(MOST_TILES, must_be.text, "ports"))
    rows: int = checked(must_be.whole(-2 * MAX_PLACE, 2 * MAX_PLACE))
    cols: int = checked(must_be.whole(-2 * MAX_PLACE, 2 * MAX_PLACE))


@dataclass(frozen=True)
class Arrange:
    """Makes another drawing of the running tiles: those that lie in both stay and keep their state."""

    cells: tuple[tuple[int, int], ...] = checked(must_be.cells)


@dataclass(frozen=True)
class Cut:
    """Cuts the cable at a side of a tile, or mends it."""

    port: str = checked(must_be.text)
    side: str = checked(must_be.side)
    on: bool = checked(must_be.switch, True)


@dataclass(frozen=True)
class Power:
    """Takes a tile's power, or gives it back; it keeps its place."""

    port: str = checked(must_be.text)
    on: bool = checked(must_be.switch)


@dataclass(frozen=True)
class Freeze:
    """Stops a tile's updates; it goes on saying its last state. Or lets it update again."""

    port: str = checked(must_be.text)
    on: bool = checked(must_be.switch, True)


@dataclass(frozen=True)
class Turn:
    """Turns a tile by 90 degrees, so that none of its links works, or back."""

    port: str = checked(must_be.text)
    on: bool = checked(must_be.switch, True)


@dataclass(frozen=True)
class Skew:
    """From now on a tile's clock is so many ppm faster than it was made."""

    port: str = checked(must_be.text)
    ppm: float = checked(must_be.number(-MAX_SKEW_PPM, MAX_SKEW_PPM))


@dataclass(frozen=True)
class Reset:
    """Resets a tile."""

    port: str = checked(must_be.text)


@dataclass(frozen=True)
class Noise:
    """From now on this share of the bytes on all cables is lost."""

    loss: float = checked(must_be.number(0, 1))


@dataclass(frozen=True)
class Blink:
    """Lets a tile blink for some seconds, so that a person finds it."""

    port: str = checked(must_be.text)
    seconds: int = checked(must_be.whole(0, MAX_BLINK_S), 5)


@dataclass(frozen=True)
class Restart:
    """Presses a tile's button: it begins again from the seed."""

    port: str = checked(must_be.text)


@dataclass(frozen=True)
class Set:
    """Sets a tile's period (ms), updates (0: for ever) or brightness; without a port, that of all tiles."""

    name: str = checked(must_be.one_of(*SETTINGS))
    value: int = checked(must_be.whole(0, 0xFFFF))
    port: str | None = checked(must_be.or_none(must_be.text), None)


# Those that change something.
Hand: TypeAlias = (
    Put
    | Pull
    | Move
    | Shift
    | Arrange
    | Cut
    | Power
    | Freeze
    | Turn
    | Skew
    | Reset
    | Noise
    | Blink
    | Restart
    | Set
)
HANDS: tuple[type[Any], ...] = get_args(Hand)
