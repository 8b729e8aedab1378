"""Tissues of tiles on the schedule of real tiles or of the paper, thousands at a time.

A `Simulator` owns many runs side by side as one flat list of cells. What a cell computes is an `Engine`: the
firmware's own core (`FastEngine`), or tensors (`tilenca.tensors`). numpy only.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from tilenca import native
from tilenca.drawings import Drawings
from tilenca.modelfile import Model
from tilenca.protocol import MESSAGE_SHIFT, SILENT_PERIODS
from tilenca.shapes import opposite

TICKS = 20  # resolution of a period on the clock schedule; the shortest latency is two ticks

SEED_STATE = 8192  # 1.0 in units of 2^-13

Schedule = Literal["random", "clock"]
States = NDArray[Any]  # (N, C), of the engine's own type


class Engine(Protocol):
    """What one cell computes, for many cells at once."""

    channels: int
    classes: int

    def seed(self, cells: int) -> States:
        """(cells, C) states of tiles that were just switched on."""

    def message(self, states: States) -> States:
        """(N, C) what cells send, and see of themselves."""

    def update(self, states: States, seen: States) -> States:
        """(N, C) new states from the old ones and (N, 5 C) messages: own, N, E, S, W."""


class FastEngine:
    """The firmware's portable core: every state to the bit as on a tile."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.channels = model.dimensions.channels
        self.classes = len(model.labels)

    def seed(self, cells: int) -> NDArray[np.int16]:
        """(cells, C) int16, the seed state."""
        states = np.zeros((cells, self.channels), np.int16)
        states[:, 0] = SEED_STATE
        return states

    def message(self, states: States) -> NDArray[np.int8]:
        """(N, C) int8, stored states rounded to their message."""
        return ((states.astype(np.int32) + (1 << MESSAGE_SHIFT - 1)) >> MESSAGE_SHIFT).astype(np.int8)

    def update(self, states: States, seen: States) -> NDArray[np.int16]:
        """(N, C) int16, one update by the firmware's core."""
        return native.update_cells(self.model, states, seen)


@dataclass(frozen=True)
class Conditions:
    """What the tiles have to live with. Times are in steps: the nominal period, one update per tile.

    Attributes:
        schedule: "random": twice per step a random half of the tiles updates and is heard at once (the
            paper's sampler); "clock": each tile has its phase, period and latency, and starts when it will.
        loss: share of messages lost, 0..1.
        lost: what is read instead of a lost message: the last one "held" (as tiles do), or "zero".
        dead: share of tiles that are silent and dark from the start; they are not counted.
        drift: largest relative difference of a tile's period from the nominal one.
        latency: least and most time a tile's message takes.
        boot: tiles are switched on within this time of each other; step 0 is when the last one is.
    """

    schedule: Schedule = "random"
    loss: float = 0.0
    lost: Literal["held", "zero"] = "held"
    dead: float = 0.0
    drift: float = 0.01
    latency: tuple[float, float] = (0.1, 0.9)
    boot: float = 10.0


@dataclass(frozen=True)
class Course:
    """How runs went.

    Attributes:
        right: (T, R) float32, share of the run's living tiles that show its class after each step.
    """

    right: NDArray[np.float32]

    @property
    def agreed(self) -> NDArray[np.bool_]:
        """(T, R) whether all tiles of the run are right after each step."""
        return self.right >= 1.0

    @property
    def settled(self) -> NDArray[np.float64]:
        """(R,) first step (from 1) from which the run stays right to the end; infinite for none."""
        wrong = ~self.agreed
        last_wrong = np.where(wrong.any(axis=0), len(wrong) - np.argmax(wrong[::-1], axis=0), 0)
        return np.where(last_wrong < len(wrong), last_wrong + 1.0, np.inf)


class Simulator:
    """R runs side by side.

    Args:
        engine: what a cell computes.
        drawings: the task.
        chosen: (R,) the drawing of each run.
        conditions: what the tiles have to live with.
        random: the only source of chance.
        states: (N, C) to start from, cells in the order of `drawings.batch(chosen)`; None: the seed state.
    """

    def __init__(
        self,
        engine: Engine,
        drawings: Drawings,
        chosen: NDArray[np.int64],
        conditions: Conditions,
        random: np.random.Generator,
        states: States | None = None,
    ) -> None:
        self.engine, self.conditions, self.random = engine, conditions, random
        self.batch = batch = drawings.batch(chosen)
        self.cells = cells = len(batch.sample)
        self.states = engine.seed(cells) if states is None else states.copy()
        self.own = engine.message(self.states)
        # What each cell holds of its N, E, S, W neighbour, and since when; the last row is nobody's.
        self.heard = np.zeros((cells + 1, 4, engine.channels), self.own.dtype)
        self.heard_at = np.full((cells + 1, 4), -np.inf)
        self.alive = self._draw_alive()
        self.updated = np.zeros(cells, np.bool_)
        self._rounds = self._random_rounds() if conditions.schedule == "random" else self._clock_rounds()

    def run(self, steps: int) -> Course:
        """Lives on for some steps."""
        right = np.empty((steps, len(self.batch.starts)), np.float32)
        for step in range(steps):
            next(self._rounds)
            right[step] = self._right()
        return Course(right)

    def _draw_alive(self) -> NDArray[np.bool_]:
        batch = self.batch
        draws = self.random.random(self.cells)
        # At least one tile of every run lives, or there would be nobody to ask.
        luckiest = np.maximum.reduceat(draws, batch.starts)[batch.sample]
        alive: NDArray[np.bool_] = (draws >= self.conditions.dead) | (draws == luckiest)
        return alive

    def _random_rounds(self) -> Iterator[None]:
        everybody = np.flatnonzero(self.alive)
        self._send(everybody, 0.0)
        now = 0.0
        while True:
            for _ in range(2):
                now += 0.5
                who = everybody[self.random.random(len(everybody)) < 0.5]
                self._update(who, now)
                self._send(who, now)
            yield

    def _clock_rounds(self) -> Iterator[None]:
        conditions, random, batch = self.conditions, self.random, self.batch
        boot = random.uniform(0, conditions.boot, self.cells)
        boot -= np.maximum.reduceat(boot, batch.starts)[batch.sample]
        period = 1 + random.uniform(-conditions.drift, conditions.drift, self.cells)
        latency = random.uniform(*conditions.latency, self.cells)
        update_at = np.where(self.alive, boot + period * random.random(self.cells), np.inf)
        arrive_at = np.full(self.cells, np.inf)
        tick = -int(np.ceil(conditions.boot)) * TICKS
        while True:
            tick += 1
            now = tick / TICKS
            arriving = np.flatnonzero(arrive_at <= now)
            self._send(arriving, now)
            arrive_at[arriving] = np.inf
            who = np.flatnonzero(update_at <= now)
            self._update(who, now)
            arrive_at[who] = update_at[who] + latency[who]
            update_at[who] += period[who]
            if tick > 0 and tick % TICKS == 0:
                yield

    def _update(self, who: NDArray[np.int64], now: float) -> None:
        heard = self.heard[who]
        if self.conditions.loss > 0 and self.conditions.lost == "zero":
            heard[self.random.random(heard.shape[:2]) < self.conditions.loss] = 0
        elif self.conditions.loss > 0:
            heard[now - self.heard_at[who] > SILENT_PERIODS] = 0
        seen = np.concatenate((self.own[who], heard.reshape(len(who), 4 * self.engine.channels)), axis=1)
        new = self.engine.update(self.states[who], seen)
        self.states[who] = new
        self.own[who] = self.engine.message(new)
        self.updated[who] = True

    def _send(self, who: NDArray[np.int64], now: float) -> None:
        neighbours = self.batch.neighbours[who]
        if self.conditions.loss > 0 and self.conditions.lost == "held":
            neighbours = np.where(
                self.random.random(neighbours.shape) < self.conditions.loss, self.cells, neighbours
            )
        for side in range(4):
            self.heard[neighbours[:, side], opposite(side)] = self.own[who]
            self.heard_at[neighbours[:, side], opposite(side)] = now

    def _right(self) -> NDArray[np.float32]:
        """(R,) share of living tiles that show their class; a tile shows nothing before its first update."""
        scores = self.states[:, -self.engine.classes :]
        right = (scores.argmax(axis=1) == self.batch.target) & self.updated & self.alive
        starts = self.batch.starts
        return (
            np.add.reduceat(right, starts, dtype=np.float32)
            / np.add.reduceat(self.alive, starts, dtype=np.float32)
        ).astype(np.float32)
