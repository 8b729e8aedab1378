"""Steps of emulated tiles, counted as the simulator counts them: by the tiles' own clocks."""

import math

import numpy as np
from numpy.typing import NDArray

from tilenca.emulator.experiment import Emulation
from tilenca.model.cost import computing_ms
from tilenca.model.file import Dimensions
from tilenca.simulator.tile_times import STEP_ENDS_MS

# From power to the moment at which a tile's first update reads its neighbours' messages, by its own clock.
FIRST_MS = 183.5

Numbers = NDArray[np.float64]


def clock_rates(ppm: Numbers) -> Numbers:
    """(N,) how fast N clocks run, of their errors."""
    return 1 + ppm * 1e-6


def first_updates_ms(rate: Numbers, switch_on_s: Numbers) -> Numbers:
    """(N,) the ms at which the first updates of N tiles begin, which got power at `switch_on_s`."""
    return switch_on_s * 1000 + FIRST_MS / rate


def right_since(running: Emulation, size: Dimensions, period_ms: float) -> float:
    """The step from which all tiles with power stay right; infinite for none.

    A step is a period, and the first one ends with the first update of the tile that was switched on last. A
    display tells which update it shows, since it follows the update's beginning by the time of computing,
    which is known to a fraction of a period. So a step ends at the same moment of the same clocks here and
    in the simulator.

    Args:
        running: a run that has ended.
        size: of the model.
        period_ms: of an update.
    """
    if not running.all_right:
        return math.inf
    standing = running.standing()
    rate = clock_rates(np.array(running.ppm)[standing])
    first_ms = first_updates_ms(rate, np.array(running.switch_on_s)[standing])
    ends = [end for one, _, other, _ in running.cables for end in (one, other)]
    computing = np.array([computing_ms(size, ends.count(tile)) for tile in standing])
    begun_ms = 1000 * np.array(running.right_from_s(standing)) - computing
    updates = np.round((begun_ms - first_ms) * rate / period_ms)
    since_ms = float((first_ms + updates * period_ms / rate).max() - first_ms.max())
    return 1 + max(0, math.ceil((since_ms - STEP_ENDS_MS) / period_ms))
