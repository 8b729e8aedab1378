"""The sentences on USB as dataclasses (docs/PROTOCOL.md section 3). `sentences` reads and writes them."""

from dataclasses import dataclass
from typing import TypeAlias

from tilenca.base.sides import SIDES
from tilenca.protocol.constants import MESSAGE_OFFSET, MISSING, PROTOCOL_VERSION


@dataclass(frozen=True)
class HelloSentence:
    """A tile's greeting at boot and on request.

    Attributes:
        tile: its id; 0: none was set.
        updates: the number after which it stops; 0: it never stops.
        reset_cause: MCUSR, as far as the tile knows it.
        firmware_id: CRC-32 of the image in its flash, see `tilenca.fleet.image.firmware_id`.
        brightness: 0..255.
        directions: 4: the channels before the classes' say on which side a tile is missing; 0: none do.
    """

    version: int
    tile: int
    model_id: int
    channels: int
    classes: int
    period_ms: int
    updates: int
    reset_cause: int
    firmware_id: int
    brightness: int
    directions: int = 0


@dataclass(frozen=True)
class TileSentence:
    """A tile's state and display; `label` is empty while nothing is shown.

    Attributes:
        class_index: the class that the tile decided for; None while nothing is shown.
        margin: how sure it is: the best score less the second best, in units of a message (0..254); None
            while nothing is shown and where there is only one class.
        links: `NESW` with `-` for every silent side.
        state: the state bytes as sent to the neighbours (message + 128), one per channel.
    """

    tile: int
    uptime_ms: int
    updates: int
    label: str
    class_index: int | None
    margin: int | None
    links: str
    state: bytes


def missing_side(hello: HelloSentence, tile: TileSentence) -> str:
    """The side on which a tile says that one is missing; empty for none, or if its model has no directions.

    Args:
        hello: of the tile.
        tile: what it says now.
    """
    first = hello.channels - hello.classes - hello.directions
    scores = [byte - MESSAGE_OFFSET for byte in tile.state[first : first + hello.directions]]
    most = max(scores, default=MISSING)
    return SIDES[scores.index(most)] if most > MISSING else ""


@dataclass(frozen=True)
class LinkSentence:
    """The counters of one side's link.

    Attributes:
        age_ms: of the last good frame; None before the first, as are the next two.
        overruns: bytes lost because a buffer was full; south: how often edges were lost, or dropped as noise.
        neighbour: id of the tile that sent the last good frame; 0 if it has none.
        neighbour_side: the side it left from, `N`, `E`, `S` or `W`.
    """

    tile: int
    uptime_ms: int
    side: str
    sent: int
    received: int
    corrupt: int
    lost: int
    foreign: int
    age_ms: int | None
    overruns: int
    neighbour: int | None
    neighbour_side: str | None


@dataclass(frozen=True)
class TimeSentence:
    """A tile's use of time and memory.

    Attributes:
        compute_us: the longest computation of an update since the last such sentence.
        awake_permille: share of the time since then that the main loop did not sleep.
        gap_us: the longest time from one turn of the main loop to the next since then.
        stack_unused: bytes of the stack's room that have never been used.
        dropped: sentences dropped since boot because the buffer was full.
    """

    tile: int
    uptime_ms: int
    compute_us: int
    awake_permille: int
    gap_us: int
    stack_unused: int
    dropped: int


@dataclass(frozen=True)
class ChipSentence:
    """The chip's fuse bytes and its lock byte, and the board's marking; at boot and on request.

    Attributes:
        revision: of the board; None where it was not marked, as is `serial`, its number.
    """

    tile: int
    low: int
    high: int
    extended: int
    lock: int
    revision: int | None = None
    serial: int | None = None

    @property
    def marking(self) -> str | None:
        """The marking as `tilenca set board` takes it."""
        return None if self.revision is None else f"{self.revision}.{self.serial}"


@dataclass(frozen=True)
class BoardSentence:
    """What a tile measures on its board. Lists are in the order of the sides, N E S W.

    Attributes:
        supply_mv: the supply in mV, right to 9 %; None before it is known.
        framing_errors: bytes without a stop bit, of each side, since boot.
        low_ms: how long each side's receiving line stayed low since boot, in stretches of 50 ms and more.
    """

    tile: int
    uptime_ms: int
    supply_mv: int | None
    framing_errors: tuple[int, ...]
    low_ms: tuple[int, ...]


@dataclass(frozen=True)
class ErrorSentence:
    """An error of a tile: a code word, and a text for people."""

    tile: int
    uptime_ms: int
    code: str
    text: str


@dataclass(frozen=True)
class AckSentence:
    """A command was carried out: its name, and the fields now in force."""

    tile: int
    command: str
    fields: tuple[str, ...] = ()


@dataclass(frozen=True)
class NakSentence:
    """A command was not carried out; `command` is empty where the tile could not tell which it was."""

    tile: int
    reason: str
    command: str = ""


@dataclass(frozen=True)
class OtherVersionSentence:
    """A good sentence of a tile whose protocol version is not ours."""

    version: int
    tile: int

    @property
    def remedy(self) -> str:
        """The fact and the remedy."""
        return (
            f"speaks protocol {self.version}, these tools speak {PROTOCOL_VERSION}: "
            "flash it with the firmware that belongs to them (tilenca flash)"
        )


Sentence: TypeAlias = (
    HelloSentence
    | TileSentence
    | LinkSentence
    | TimeSentence
    | ChipSentence
    | BoardSentence
    | ErrorSentence
    | AckSentence
    | NakSentence
    | OtherVersionSentence
)
