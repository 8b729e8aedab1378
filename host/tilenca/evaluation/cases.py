"""A set of drawings to measure, and how long its tiles have to agree."""

from dataclasses import dataclass

from tilenca.shapes.batch import Drawings
from tilenca.shapes.sizes import Size

# Area of the bounding box up to which tiles have so many steps; the last one is for all beyond.
STEPS = ((42, 60), (196, 100), (400, 200), (500, 300))
MOST_STEPS = 400
SHORT_STEPS, LARGE_STEPS, VERY_LARGE_STEPS = (steps for _, steps in STEPS[:3])


@dataclass(frozen=True)
class Case:
    """One set of drawings to measure.

    Attributes:
        kind: decides the target, see `tilenca.evaluation.metrics.TARGETS`.
        name: as tables call it.
        drawings: with the model's labels.
        steps: the number of steps after which all tiles must agree.
        held_out: whether training never saw these drawings.
        aimed: whether the model was trained for such drawings, so that there is a target to reach.
        dead: share of dead tiles, 0..1.
    """

    kind: str
    name: str
    drawings: Drawings
    steps: int
    held_out: bool = False
    aimed: bool = True
    dead: float = 0.0


def steps_for(size: Size) -> int:
    """The steps in which the tiles of a drawing of this size must agree."""
    area = size[0] * size[1]
    return next((steps for most, steps in STEPS if area <= most), MOST_STEPS)
