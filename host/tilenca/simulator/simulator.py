"""Batches of grids on the schedule of real tiles or of the paper, thousands at a time.

A `Simulator` owns many runs side by side as one flat list of cells. An `Engine` computes the cells.
`FastEngine` is the firmware's own core, compiled together with the schedule (`rollout_library`). Any other
engine, such as tensors (`tilenca.training.float_engine`), follows the same schedule in numpy
(`numpy_rollout`).
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch, Drawings
from tilenca.simulator.engine import Engine, FastEngine, States
from tilenca.simulator.numpy_rollout import NumpyRollout
from tilenca.simulator.rollout_library import DARK, NOBODY, CompiledRollout, Setup

ScheduleKind = Literal["random", "clock"]
FaultKind = Literal["dead", "stuck", "away"]

# Cell updates between two checks for Ctrl-C: some tenths of a second.
ATTENTION = 500_000


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
            at once (the paper's sampler); "clock": each tile has its own phase, period, latency and start.
        loss: share of messages lost, 0..1.
        lost: the substitute for a lost message: the last one "held" until its sender was silent for
            `SILENT_PERIODS` steps (as tiles do), or "zero".
        dead: share of tiles that are silent and dark from the start; they are not counted.
        drift: largest relative difference of a tile's period from the nominal one.
        latency: least and most time a tile's message takes, less than the shortest period.
        boot: tiles are switched on within this time of each other; step 0 is when the last one is.
        fault: of one tile of each run; None: none.

    Raises:
        ValueError: a value is out of range.
    """

    schedule: ScheduleKind = "random"
    loss: float = 0.0
    lost: Literal["held", "zero"] = "held"
    dead: float = 0.0
    drift: float = 0.01
    latency: tuple[float, float] = (0.1, 0.9)
    boot: float = 10.0
    fault: Fault | None = None

    def __post_init__(self) -> None:
        if self.schedule not in ("random", "clock") or self.lost not in ("held", "zero"):
            raise ValueError(f"no such schedule or loss: {self.schedule!r}, {self.lost!r}")
        if not (0 <= self.loss <= 1 and 0 <= self.dead <= 1):
            raise ValueError(f"loss {self.loss} and dead {self.dead} must be shares, 0..1")
        in_time = 0 < self.latency[0] <= self.latency[1] < 1 - self.drift
        if not (in_time and self.drift >= 0 and 0 <= self.boot < float("inf")):
            raise ValueError(
                f"drift {self.drift}, boot {self.boot}, latency {self.latency}: none is negative, and a "
                "message arrives before its sender sends the next"
            )


@dataclass(frozen=True)
class Trajectory:
    """The results of runs, step by step.

    Attributes:
        right: (T, R) float32, share of the run's living tiles that show its class after each step.
        shown: (T, N) int8, the class each tile shows after each step, -1 for dark; None: not recorded.
    """

    right: NDArray[np.float32]
    shown: NDArray[np.int8] | None = None

    @property
    def agreed(self) -> NDArray[np.bool_]:
        """(T, R) whether all tiles of the run are right after each step."""
        return self.right >= 1.0

    @property
    def converged_at(self) -> NDArray[np.float64]:
        """(R,) first step (from 1) from which the run stays right to the end; infinite for none."""
        wrong = ~self.agreed
        last_wrong = np.where(wrong.any(axis=0), len(wrong) - np.argmax(wrong[::-1], axis=0), 0)
        return np.where(last_wrong < len(wrong), last_wrong + 1.0, np.inf)


class Simulator:
    """R independent runs side by side.

    Args:
        engine: computes the cells' updates.
        drawings: the task.
        chosen: (R,) the drawing of each run.
        conditions: of all runs.
        random: the only source of chance; it is used here only, not during the runs.
        states: (N, C) to start from, cells in the order of `drawings.batch(chosen)`; None: the seed state.
        threads: how many to use, None: one per processor; results do not depend on it.

    Attributes:
        chosen: (R,) the drawing of each run.
        batch: the cells.
        states: (N, C) current states; not to be written to.
        shown: (N,) int8, the class each tile shows now, -1 for dark.
        alive: (N,) whether a tile is not one of `conditions.dead`.
        setup: the random choices of all runs, drawn beforehand.

    Raises:
        ValueError: `states` or `conditions.fault` do not fit the runs, or a run has no tile that counts.
    """

    def __init__(
        self,
        engine: Engine,
        drawings: Drawings,
        chosen: NDArray[np.int64],
        conditions: Conditions,
        random: np.random.Generator,
        states: States | None = None,
        *,
        threads: int | None = None,
    ) -> None:
        self.threads = processors() if threads is None else threads
        self.chosen = chosen
        self.batch = batch = drawings.batch(chosen)
        self.cells = cells = len(batch.sample)
        self.states = engine.seed(cells) if states is None else np.array(states, order="C")
        if self.states.shape != (cells, engine.channels):
            raise ValueError(f"states are {self.states.shape}, the runs need {(cells, engine.channels)}")
        self.shown = np.full(cells, DARK, np.int8)
        self.setup = _draw_setup(batch, conditions, random)
        self.alive = self.setup.alive
        self._rollout: CompiledRollout | NumpyRollout
        if isinstance(engine, FastEngine):
            self._rollout = CompiledRollout(engine.model, self.setup, self.states, self.shown)
        else:
            self._rollout = NumpyRollout(engine, self.setup, self.states, self.shown)

    def run(
        self, steps: int, record: bool = False, tell: Callable[[int], None] = lambda done: None
    ) -> Trajectory:
        """Runs some more steps.

        Args:
            steps: how many.
            record: whether to keep the class that every tile shows after each step.
            tell: called at intervals with the number of steps done.
        """
        right = np.empty((steps, len(self.batch.starts)), np.float32)
        shown = np.empty((steps, self.cells), np.int8) if record else None
        stride = max(1, ATTENTION * self.threads // self.cells)
        for step in range(0, steps, stride):
            part = slice(step, step + stride)
            self._rollout.run(right[part], None if shown is None else shown[part], self.threads)
            tell(min(step + stride, steps))
        return Trajectory(right, shown)

    @property
    def updates(self) -> int:
        """The number of cell updates computed in all."""
        return self._rollout.updates


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _draw_setup(batch: Batch, conditions: Conditions, random: np.random.Generator) -> Setup:
    """Draws everything that chance decides, before the runs begin."""
    fault = conditions.fault
    alive = _draw_alive(batch, conditions.dead, random)
    faulty = _faulty(batch, fault)
    counted = alive.copy()
    if fault is not None and fault.kind != "away":
        counted[faulty[faulty != NOBODY]] = False
    if not np.logical_or.reduceat(counted, batch.starts).all():
        raise ValueError("fault: a run has no other living tile, so none is left to count")
    return Setup(
        starts=np.append(batch.starts, len(batch.sample)),
        neighbours=batch.neighbours,
        alive=alive,
        target=batch.target,
        seeds=random.integers(1 << 64, size=len(batch.starts), dtype=np.uint64),
        loss=conditions.loss,
        zeros=conditions.lost == "zero",
        clocks=_draw_clocks(batch, conditions, random) if conditions.schedule == "clock" else None,
        fault=fault.kind if fault else "none",
        faulty=faulty,
        begin=fault.begin if fault else 0,
        end=(fault.end or 0) if fault else 0,
    )


def _draw_alive(batch: Batch, dead: float, random: np.random.Generator) -> NDArray[np.bool_]:
    draws = random.random(len(batch.sample))
    # At least one tile of every run stays alive, so that one is left to count.
    luckiest = np.maximum.reduceat(draws, batch.starts)[batch.sample]
    alive: NDArray[np.bool_] = (draws >= dead) | (draws == luckiest)
    return alive


def _draw_clocks(
    batch: Batch, conditions: Conditions, random: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float]:
    """First update, period and latency of every cell, and when the first one is switched on, in steps."""
    cells = len(batch.sample)
    boot = random.uniform(0, conditions.boot, cells)
    boot -= np.maximum.reduceat(boot, batch.starts)[batch.sample]
    period = 1 + random.uniform(-conditions.drift, conditions.drift, cells)
    latency = random.uniform(*conditions.latency, cells)
    return boot + period * random.random(cells), period, latency, -np.ceil(conditions.boot)


def _faulty(batch: Batch, fault: Fault | None) -> NDArray[np.int64]:
    """(R,) the cell with the fault in each run, `NOBODY` for none."""
    runs = len(batch.starts)
    if fault is None:
        return np.full(runs, NOBODY, np.int64)
    sizes = np.bincount(batch.sample, minlength=runs)
    tiles = np.asarray(fault.tiles)
    if tiles.shape != (runs,) or not ((tiles >= NOBODY) & (tiles < sizes)).all():
        raise ValueError(f"fault: {runs} runs need as many tiles, each a number in its drawing or {NOBODY}")
    return np.where(tiles == NOBODY, NOBODY, batch.starts + tiles)
