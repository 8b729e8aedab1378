"""Progress reports of a training run. No torch here: views import it."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """One report of a run.

    Attributes:
        seed: of the run.
        iteration: how many are done.
        loss, agreement: means over the last iterations.
        check: targets held, targets and shortfall in the last short measurement; None: none yet.
        rows: measured rows and all rows of a short measurement that is at work; None: none is.
    """

    seed: int
    iteration: int
    loss: float
    agreement: float
    check: tuple[int, int, float] | None
    rows: tuple[int, int] | None = None


Tell = Callable[[Progress], None]
