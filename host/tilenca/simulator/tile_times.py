"""The times of real tiles: how long they compute, how long messages are on their way, and who hears them.

All were measured on emulated tiles, in milliseconds (docs/DESIGN.md says how).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import EAST, SIDES, WEST
from tilenca.model.cost import BITS_PER_BYTE, computing_ms, frame_bytes
from tilenca.model.file import Dimensions
from tilenca.protocol.constants import LINK_BAUD, ROW_BAUD
from tilenca.simulator.rollout_library import TICKS_PER_STEP, UNITS_PER_STEP, Clocks

# What a message takes on top of its line, by the side that it leaves from: a tile packs the frames of N, E, S
# and W one after another, and the receiver unpacks it. South is a UART in software.
HANDLING_MS = (0.96, 0.96, 1.71, 1.76)
# From one period before the first update: a tile listens this much earlier, and sends its seed later.
LISTENS_MS = 0.8
SEED_MS = 1.05
# Emulated tiles end a step this much after the last tile's update begins (`tilenca.sweep.emulated`).
STEP_ENDS_MS = 3.1
DRIFT = 0.003  # of emulated tiles
# Arrivals and updates count at the end of their tick, an arrival first, which is half a tick too early.
HALF_TICK = 0.5 / TICKS_PER_STEP
SHORTER = 2 / UNITS_PER_STEP  # than its period a latency must be


@dataclass(frozen=True)
class TileTimes:
    """The times of tiles with one model, in periods.

    Attributes:
        computing: of an update, by the number of neighbours, 0 to 4.
        sending: from its end to the moment at which a neighbour can read it, by the side N, E, S, W.
        millisecond: of the tile's time.
    """

    computing: tuple[float, ...]
    sending: tuple[float, ...]
    millisecond: float

    @property
    def ends(self) -> float:
        """How long after an update of the last tile begins a step ends."""
        return STEP_ENDS_MS * self.millisecond

    def clocks(self, period: NDArray[np.float64], neighbours: NDArray[np.int64]) -> Clocks:
        """The clocks of N tiles that are all switched on at 0.

        Args:
            period: (N,) of each.
            neighbours: (N,) how many each has.

        Returns:
            What would take longer than its sender's period arrives just before the next update.
        """
        sending = np.array(self.sending) + HALF_TICK
        latency = np.array(self.computing)[neighbours][:, None] + sending
        seed = np.broadcast_to(sending + SEED_MS * self.millisecond, latency.shape)
        longest = period[:, None] - SHORTER
        return Clocks(
            period,
            period,
            np.minimum(latency, longest),
            0.0,
            np.minimum(seed, longest),
            np.maximum(sending - LISTENS_MS * self.millisecond, 0.0),
        )


def tile_times(size: Dimensions, period_ms: float) -> TileTimes:
    """The times of tiles with a network of that size.

    Args:
        size: of the model.
        period_ms: of an update.
    """
    bits = frame_bytes(size.channels) * BITS_PER_BYTE
    bauds = [ROW_BAUD if side in (EAST, WEST) else LINK_BAUD for side in range(len(SIDES))]
    sending = [handling + 1000 * bits / baud for handling, baud in zip(HANDLING_MS, bauds, strict=True)]
    return TileTimes(
        tuple(computing_ms(size, neighbours) / period_ms for neighbours in range(len(SIDES) + 1)),
        tuple(ms / period_ms for ms in sending),
        1 / period_ms,
    )
