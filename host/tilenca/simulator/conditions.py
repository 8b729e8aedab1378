"""The conditions of simulated runs: schedule, losses, faults, and tiles put down and taken away."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Dimensions
from tilenca.simulator.rollout_library import SCHEDULES
from tilenca.simulator.tile_times import TileTimes, tile_times

ScheduleKind = Literal["random", "clock", "listing"]
FaultKind = Literal["dead", "stuck", "away"]
Switches = NDArray[np.int32]
USUAL_LATENCY = (0.1, 0.9)
AS_TILES = "tiles"  # a latency
MOST_LATENCY = 0.98  # a message arrives before its sender sends the next, with a period 1 % off


@dataclass(frozen=True)
class Fault:
    """A fault of one tile of each run. A tile that is dead or stuck does not count when a run is judged.

    Attributes:
        kind: "dead": silent and dark from step `begin` on; "stuck": does not update from then on, but goes on
            sending the state it had; "away": switched off and dark then, and on again at `end`, in the seed
            state.
        tiles: (R,) which tile of its drawing, -1 for none of that run.
        begin: steps before the fault begins; 0: it begins before the first tile is switched on.
        end: steps before a tile that was away is back.

    Raises:
        ValueError: the steps do not fit the kind.
    """

    kind: FaultKind
    tiles: NDArray[np.int64]
    begin: int = 0
    end: int | None = None

    def __post_init__(self) -> None:
        if self.kind not in get_args(FaultKind):
            raise ValueError(f"no such fault: {self.kind!r}")
        if self.begin < 0 or (self.end is not None) != (self.kind == "away"):
            raise ValueError(
                f"fault {self.kind!r}: begin is {self.begin}, end is {self.end}; only 'away' ends"
            )
        if self.end is not None and self.end <= self.begin:
            raise ValueError(f"fault: ends at {self.end}, but begins at {self.begin}")


@dataclass(frozen=True)
class Conditions:
    """The conditions of a run. Times are in steps: the nominal period, one update per tile.

    Attributes:
        schedule: "random": twice per step a random half of the tiles updates and its messages arrive
            at once; "listing": as in the paper's listing, as many tiles as there are in a run are drawn in a
            step, with replacement and one after another, and neighbours see each update at once; "clock":
            each tile has its own phase, period, latency and start, and does what docs/PROTOCOL.md section 1
            says: it sends its seed when it is switched on, and updates for the first time one period later.
        loss: share of messages lost, 0..1.
        lost: the substitute for a lost message: the last one "held" until its sender was silent for
            `SILENT_PERIODS` steps (as tiles do), or "zero".
        dead: share of tiles that are silent and dark from the start; they are not counted.
        drift: largest relative difference of a tile's period from the nominal one.
        latency: least and most time a tile's message takes, less than the shortest period; or the times
            that tiles have, side by side, see `tilenca.simulator.tile_times`.
        boot: tiles are switched on within this time of each other; step 0 is when the last one is. With less
            than a period all tiles' phases are that close together.
        fault: of one tile of each run; None: none.

    Raises:
        ValueError: a value is out of range.
    """

    schedule: ScheduleKind = "random"
    loss: float = 0.0
    lost: Literal["held", "zero"] = "held"
    dead: float = 0.0
    drift: float = 0.01
    latency: tuple[float, float] | TileTimes = USUAL_LATENCY
    boot: float = 10.0
    fault: Fault | None = None

    def __post_init__(self) -> None:
        if self.schedule not in SCHEDULES or self.lost not in ("held", "zero"):
            raise ValueError(f"no such schedule or loss: {self.schedule!r}, {self.lost!r}")
        if not (0 <= self.loss <= 1 and 0 <= self.dead <= 1):
            raise ValueError(f"loss {self.loss} and dead {self.dead} must be shares, 0..1")
        drawn = (0.1, 0.1) if isinstance(self.latency, TileTimes) else self.latency
        in_time = 0 < drawn[0] <= drawn[1] < 1 - self.drift
        if not (in_time and self.drift >= 0 and 0 <= self.boot < float("inf")):
            raise ValueError(
                f"drift {self.drift}, boot {self.boot}, latency {self.latency}: none is negative, and a "
                "message arrives before its sender sends the next"
            )


def parse_latency(text: str) -> tuple[float, float]:
    """Parses what messages take, in periods: `0.77` for all of them, or `0.1-0.9` from least to most.

    Raises:
        ValueError: it is not valid; the message says why.
    """
    least, dash, most = text.partition("-")
    try:
        latency = float(least), float(most if dash else least)
    except ValueError:
        raise ValueError(
            f"'{text}' is neither a number of periods nor two of them, such as 0.1-0.9"
        ) from None
    if not 0 < latency[0] <= latency[1] <= MOST_LATENCY:
        raise ValueError(f"'{text}': messages take more than 0 and at most {MOST_LATENCY} periods")
    return latency


def latency_of(text: str, size: Dimensions, period_ms: float) -> tuple[float, float] | TileTimes:
    """What messages take: as `parse_latency` says, or with `tiles` what they take on tiles, by their side.

    Args:
        text: as it is given.
        size: of the model.
        period_ms: of an update.

    Raises:
        ValueError: it is not valid; the message says why.
    """
    return tile_times(size, period_ms) if text == AS_TILES else parse_latency(text)


@dataclass(frozen=True)
class Rebuilding:
    """Tiles put down and taken away while the others run, in a grid with a cell for all of them.

    A tile that is taken away falls silent: its neighbours hold its last message for `SILENT_PERIODS` more.
    One that is put down begins as every tile that is switched on. Tiles that are not there are not counted.

    Attributes:
        present: (N,) bool, the tiles that are there at the start, of cells in the order of
            `Drawings.batch`.
        switches: (K, 3) int32, in the order of their steps: before the step of that number (from 0), the
            cell's tile is put down (1) or taken away (0).
    """

    present: NDArray[np.bool_]
    switches: Switches
