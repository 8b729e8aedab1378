"""Grids that never come to rest, under every kind of schedule and fault."""

from dataclasses import replace
from typing import Any

import numpy as np

from firmware.synthetic_models import random_network
from support.reference_network import reference
from tilenca.model.file import Dimensions, Model
from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import Shape
from tilenca.simulator.conditions import Conditions, Fault, Rebuilding
from tilenca.simulator.engine import ExactEngine, FastEngine, States
from tilenca.simulator.simulator import Simulator
from tilenca.simulator.tile_times import TileTimes

CHANNELS = 6
# Sides and seeds of their own, lines that a tile switched on meanwhile does not hear, and some just in time.
TIMES = TileTimes((0.2, 0.3, 0.4, 0.5, 0.6), (0.5, 0.1, 0.55, 0.2), 0.05)


def restless_model() -> Model:
    """A network that never comes to rest: each state swings around zero, driven by what the neighbours do."""
    random = random_network(Dimensions(CHANNELS, 4 * CHANNELS, 4 * CHANNELS), 40, seed=5)
    integer = {name: array.copy() for name, array in random.integer.items()}
    swing = np.arange(2 * CHANNELS)  # the units that hold the own message's parts above and below zero
    own, sign = swing // 2, 1 - 2 * (swing % 2)
    for name in ("w1", "w2"):
        integer[name][swing] = 0
    integer["w1"][2 * CHANNELS :, :CHANNELS] = 0  # all others listen to the neighbours
    integer["w1"][swing, own] = 127 * sign
    integer["w2"][swing, swing] = 64
    integer["w3"][own, swing] = -120 * sign
    for name in ("b1", "b2", "b3"):
        integer[name] //= 20
    return replace(random, labels=("0", "1", "2"), integer=integer)


MODEL = restless_model()


LETTERS = Drawings(
    (
        Shape("0", ("###", "#.#", "###"), "0"),
        Shape("1", ("#", "#", "#"), "1"),
        Shape("2", ("##.", ".##"), "2"),
    ),
    (0, 0, 0), ("0", "1", "2"), ({"file": "letters.toml", "sha256": ""},),
)  # fmt: skip


def block(rows: int, cols: int) -> Drawings:
    """One drawing full of tiles."""
    shape = Shape("0", ("#" * cols,) * rows, "0")
    return Drawings((shape,), (0,), ("0", "1", "2"), ({"file": "block.toml", "sha256": ""},))


class PlainEngine(ExactEngine):
    """The arithmetic in numpy, so that `Simulator` goes round by round."""

    def update(self, states: States, seen: States) -> States:
        return reference(self.model, states, seen).astype(np.int16)


def simulator(
    conditions: Conditions,
    fault: Fault | None = None,
    runs: int = 2,
    drawings: Drawings = LETTERS,
    engine: Any = FastEngine,
    seed: int = 11,
    threads: int | None = 1,
    rebuilding: Rebuilding | None = None,
) -> Simulator:
    chosen = np.tile(np.arange(len(drawings)), runs)
    random = np.random.default_rng(seed)
    conditions = replace(conditions, fault=fault)
    return Simulator(
        engine(MODEL), drawings, chosen, conditions, random, threads=threads, rebuilding=rebuilding
    )


CONDITIONS = [
    Conditions("random"),
    Conditions("random", loss=0.3, dead=0.1),
    Conditions("random", loss=0.9),
    Conditions("random", loss=0.2, lost="zero"),
    Conditions("listing"),
    Conditions("listing", loss=0.3, dead=0.1),
    Conditions("listing", loss=0.9),
    Conditions("listing", loss=0.2, lost="zero"),
    Conditions("clock"),
    Conditions("clock", loss=0.3, dead=0.1),
    Conditions("clock", loss=0.9, boot=0.0),
    Conditions("clock", loss=0.2, lost="zero", drift=0.08),
    Conditions("clock", loss=1.0, latency=(0.05, 0.98), boot=3.7),
    Conditions("clock", latency=TIMES, boot=5.0),
    Conditions("clock", loss=0.3, dead=0.1, latency=TIMES, boot=2.0),
]


TILES = np.array([3, 1, -1, 0, 2, 3])


FAULTS = [
    Fault("dead", TILES),
    Fault("dead", TILES, begin=9),
    Fault("stuck", TILES),
    Fault("stuck", TILES, begin=9),
    Fault("away", TILES, begin=5, end=7),
    Fault("away", TILES, begin=5, end=14),
    Fault("away", TILES, begin=0, end=6),
]


def same(one: Simulator, other: Simulator, steps: int) -> bool:
    """Whether two simulators have the same trajectories."""
    trajectories = [rollout.run(steps, record=True) for rollout in (one, other)]
    return (
        np.array_equal(one.states, other.states)
        and np.array_equal(trajectories[0].right, trajectories[1].right)
        and np.array_equal(trajectories[0].shown, trajectories[1].shown)  # type: ignore[arg-type]
        and one.updates == other.updates
    )
