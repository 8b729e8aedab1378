"""The figures of benchmarks that are compared from run to run: ratios and exact counts, no wall times.

A benchmark notes what it has measured; at the end of `make bench`, `bench.history` compares and keeps it.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median

from tilenca.base.paths import BUILD

NOTED = BUILD / "bench" / "figures.jsonl"


@dataclass(frozen=True)
class Figure:
    """One number of a benchmark.

    Attributes:
        name: of the benchmark and what it tells, such as `kernel: hidden 96, young grid`.
        value: the number.
        unit: what it counts, such as `cycles`.
        noise: how far the rounds of this run lay apart, as a share of the value; 0: it is exact.
        more_is_better: whether a smaller value is a slide.
    """

    name: str
    value: float
    unit: str
    noise: float = 0.0
    more_is_better: bool = False


def exact(name: str, value: float, unit: str) -> Figure:
    """A count that is the same on every machine; less is better."""
    return Figure(name, float(value), unit)


def of_rounds(name: str, rounds: Sequence[float], unit: str, more_is_better: bool = True) -> Figure:
    """The median of some rounds, with their range as noise.

    Args:
        name: see Figure.
        rounds: (R,) one value above 0 for each, at least two.
        unit: see Figure.
        more_is_better: see Figure.

    Raises:
        ValueError: there are too few rounds to know the noise.
    """
    if len(rounds) < 2:
        raise ValueError(f"{name}: one round tells no noise")
    middle = float(median(rounds))
    return Figure(name, middle, unit, (max(rounds) - min(rounds)) / middle, more_is_better)


def note(*figures: Figure, place: Path = NOTED) -> None:
    """Keeps figures until the end of the run."""
    place.parent.mkdir(parents=True, exist_ok=True)
    with place.open("a", encoding="utf-8") as file:
        for figure in figures:
            file.write(json.dumps(asdict(figure)) + "\n")


def noted(place: Path = NOTED) -> list[Figure]:
    """What was noted, each figure as it was last."""
    if not place.exists():
        return []
    lines = place.read_text(encoding="utf-8").splitlines()
    found = [Figure(**json.loads(line)) for line in lines]
    return list({figure.name: figure for figure in found}.values())
