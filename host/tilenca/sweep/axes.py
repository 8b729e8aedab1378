"""`--axis NAME=VALUES`: what a sweep varies.

loss=0:0.6:0.05             from, to (included), step
loss=0,0.1,0.5              some values
size=5x4,7x6,drawn          sizes, and the files' own drawings
drawings=drawn,damaged      words
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import product

from tilenca.base.errors import UsageError
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.shapes.sizes import parse_size
from tilenca.simulator.conditions import AS_TILES, USUAL_LATENCY, Conditions, parse_latency
from tilenca.simulator.rollout_library import SCHEDULES

FAST, EMULATOR = "fast", "emulator"
ENGINES = (FAST, EMULATOR)
EXAMPLE = "loss=0:0.6:0.05 or size=5x4,7x6"
MAX_VALUES = 1000  # of one axis
MAX_CELLS = 100_000
AS_DRAWN = "drawn"  # a size
KINDS = ("drawn", "damaged", "varied", "unknown")  # of drawings
LATENCY = "-".join(map(str, USUAL_LATENCY))
STEP_S = DEFAULT_PERIOD_MS / 1000  # at the pace of real tiles
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)

Value = float | str
Point = Mapping[str, Value]  # a value of every axis


@dataclass(frozen=True)
class AxisKind:
    """What an axis may be.

    Attributes:
        about: for the help.
        default: the value where there is no such axis, by engine; an engine without one cannot do it.
        most: numbers go from 0 to this; None: values are words.
        whole: whether numbers are whole ones.
        words: the possible words; empty: any that `read` takes.
        read: refuses other words with a ValueError.
    """

    about: str
    default: Mapping[str, Value]
    most: float | None = None
    whole: bool = False
    words: tuple[str, ...] = ()
    read: Callable[[str], object] = field(default_factory=lambda: str)


def _both(fast: Value, emulator: Value) -> dict[str, Value]:
    return {FAST: fast, EMULATOR: emulator}


def _read_size(text: str) -> None:
    if text != AS_DRAWN:
        parse_size(text)


def _read_latency(text: str) -> None:
    if text != AS_TILES:
        parse_latency(text)


AXES: dict[str, AxisKind] = {
    "model": AxisKind("models: folders or short names", _both("", "")),
    "drawings": AxisKind("kinds of drawings", _both(KINDS[0], KINDS[0]), words=KINDS),
    "size": AxisKind(f"rows x columns, or {AS_DRAWN}", _both(AS_DRAWN, AS_DRAWN), read=_read_size),
    "schedule": AxisKind(
        "as of evaluate", {FAST: "clock"}, words=("clock", *sorted(set(SCHEDULES) - {"clock"}))
    ),
    "lost": AxisKind("as of evaluate", {FAST: "held"}, words=("held", "zero")),
    "loss": AxisKind("share of messages lost", _both(0.0, 0.0), 1.0),
    "flip": AxisKind("share of bits inverted on the cables", _both(0.0, 0.0), 1.0),
    "dead": AxisKind("share of tiles that are dead", _both(0.0, 0.0), 1.0),
    "stuck": AxisKind("tiles of each run that are stuck after 5 steps: 0 or 1", {FAST: 0.0}, 1.0, whole=True),
    "ppm": AxisKind("clock errors within +-ppm", _both(Conditions.drift * 1e6, 3000.0), 90_000.0),
    "delay": AxisKind("further delay of the cables, ms", {EMULATOR: 0.0}, 1000.0),
    "boot-spread": AxisKind(
        "switched on within so many seconds", _both(Conditions.boot * STEP_S, 1.0), 3600.0
    ),
    "latency": AxisKind(
        f"what a message takes, in periods: 0.5, or between 0.1-0.9; {AS_TILES}: as on tiles, by its side",
        {FAST: LATENCY},
        read=_read_latency,
    ),
}


@dataclass(frozen=True)
class Axis:
    """One axis of a sweep.

    Attributes:
        name: a key of `AXES`.
        values: in the order given, each once.
    """

    name: str
    values: tuple[Value, ...]

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers."""
        return AXES[self.name].most is not None


def text_of(value: Value) -> str:
    """A value as it may be given again."""
    return value if isinstance(value, str) else f"{value:.12g}"


def parse_axis(text: str) -> Axis:
    """Parses an `--axis`.

    Raises:
        UsageError: it is not valid; the message says why.
    """
    name, equals, given = text.partition("=")
    if name not in AXES:
        raise _complaint(text, f"there is no axis '{name}'; there is: {', '.join(AXES)}")
    if not equals or not given:
        raise _complaint(text, "no values")
    kind = AXES[name]
    if kind.most is None:
        values: list[Value] = [_word(text, kind, word) for word in given.split(",")]
    else:
        numbers = [number for part in given.split(",") for number in _numbers(text, kind, part)]
        values = [float(number) for number in numbers]
    shown = [text_of(value) for value in values]
    if len(shown) > MAX_VALUES:
        raise _complaint(text, f"more than {MAX_VALUES} values")
    if twice := [value for value in shown if shown.count(value) > 1]:
        raise _complaint(text, f"{twice[0]} is there twice")
    return Axis(name, tuple(values))


def _word(text: str, kind: AxisKind, word: str) -> str:
    if kind.words and word not in kind.words:
        raise _complaint(text, f"'{word}' is none of {', '.join(kind.words)}")
    try:
        kind.read(word)
    except ValueError as error:
        raise _complaint(text, str(error)) from error
    if not word.strip() or word != word.strip():
        raise _complaint(text, "a value is empty or has blanks around it")
    return word


def _numbers(text: str, kind: AxisKind, part: str) -> list[Decimal]:
    """The numbers of `A` or `A:B:STEP`."""
    pieces = part.split(":")
    if len(pieces) == 1:
        return [_number(text, kind, part)]
    if len(pieces) != 3:
        raise _complaint(text, f"'{part}' is neither a number nor FROM:TO:STEP")
    first, last, step = (_number(text, kind, piece) for piece in pieces)
    if last < first or step <= 0:
        raise _complaint(text, f"'{part}' does not go up from FROM to TO by a STEP above 0")
    if last - first > step * MAX_VALUES:
        raise _complaint(text, f"more than {MAX_VALUES} values")
    return [first + number * step for number in range(int((last - first) / step) + 1)]


def _number(text: str, kind: AxisKind, piece: str) -> Decimal:
    number = Decimal(piece) if _NUMBER.fullmatch(piece) else Decimal(-1)
    if not 0 <= number <= Decimal(str(kind.most)) or (kind.whole and number != int(number)):
        what = "a whole number" if kind.whole else "a number"
        raise _complaint(text, f"'{piece}' is not {what} from 0 to {kind.most:.12g}")
    return number


def _complaint(text: str, fact: str) -> UsageError:
    return UsageError(f"--axis '{text}': {fact}; for example {EXAMPLE}")


def points(axes: Sequence[Axis], engine: str) -> list[Point]:
    """Every combination of the axes' values, the last axis fastest; other axes have their default.

    Args:
        axes: of the sweep.
        engine: one of `ENGINES`.

    Raises:
        UsageError: an axis is there twice, the engine cannot do it, or there are too many combinations.
    """
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"--axis {name}: it is there twice; give all its values in one")
        if engine not in AXES[name].default:
            (other,) = AXES[name].default
            raise UsageError(
                f"--axis {name}: engine {engine} cannot do it; leave it out, or give --engine {other}"
            )
    count = 1
    for axis in axes:
        count *= len(axis.values)
    if count > MAX_CELLS:
        raise UsageError(f"--axis: {count:,} combinations, at most {MAX_CELLS:,}; give fewer values")
    if {"dead", "stuck"} <= set(names):
        raise UsageError(
            "--axis dead and --axis stuck: together they could leave no tile to ask; give one of them"
        )
    _check_latency(axes)
    usual = {name: kind.default[engine] for name, kind in AXES.items() if engine in kind.default}
    return [
        usual | dict(zip(names, values, strict=True)) for values in product(*(axis.values for axis in axes))
    ]


def _check_latency(axes: Sequence[Axis]) -> None:
    """Refuses messages that take longer than the shortest period."""
    values = {axis.name: axis.values for axis in axes}
    given = [str(text) for text in values.get("latency", (LATENCY,)) if text != AS_TILES]
    # Without any, messages take what the clocks of tiles allow.
    longest = max((parse_latency(text)[1] for text in given), default=0.0)
    drift = max(float(ppm) for ppm in values.get("ppm", (0.0,))) / 1e6
    if longest >= 1 - drift:
        raise UsageError(
            f"--axis latency: messages of {longest:g} periods take longer than the shortest period with "
            "--axis ppm; give less of one of them"
        )
