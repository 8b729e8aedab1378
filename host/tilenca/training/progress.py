"""What a training run tells of its progress. No torch here: views import it."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """What a run tells now and then.

    Attributes:
        seed: whose it is.
        iteration: how far it is.
        loss, agreement: means over the last iterations.
        check: targets held, targets and shortfall in the last short measurement; None: none yet.
    """

    seed: int
    iteration: int
    loss: float
    agreement: float
    check: tuple[int, int, float] | None


Tell = Callable[[Progress], None]
