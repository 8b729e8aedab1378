"""Compiled rollouts of a batch of grids (tools/simulator): the schedule, the messages and the updates.

`CompiledRollout` computes all of it with the firmware's core. `TickSchedule` only gives the events of each
tick, for engines that compute other states; both follow the same schedule, number by number.
"""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import Model
from tilenca.simulator.core_library import CModel, address, library

TICKS_PER_STEP = 20  # kTicks of schedule.h: the resolution of a step on clocks
UNITS_PER_STEP = TICKS_PER_STEP << 16  # kUnits of a tick
LOSS_UNITS = 1 << 32
DARK = -1
FAULTS = ("none", "dead", "stuck", "away")  # TilencaFault
NOBODY = -1

Cells = NDArray[np.int32]


class _CSetup(ctypes.Structure):
    """`TilencaSetup` of tools/simulator/setup.h."""

    _fields_ = (
        ("runs", ctypes.c_int32),
        ("cells", ctypes.c_int32),
        *((name, ctypes.c_void_p) for name in ("starts", "neighbours", "alive", "target", "seeds")),
        ("loss", ctypes.c_uint64),
        ("zeros", ctypes.c_uint8),
        ("clocks", ctypes.c_uint8),
        ("start", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("first", "period", "latency")),
        ("fault", ctypes.c_uint8),
        ("faulty", ctypes.c_void_p),
        ("begin", ctypes.c_int64),
        ("end", ctypes.c_int64),
    )


@dataclass(frozen=True)
class Setup:
    """R runs of N cells in all, and their conditions; times on clocks are in units of a step.

    Attributes:
        starts: (R + 1,) the first cell of each run, and N.
        neighbours: (N, 4) N, E, S, W; N for none.
        alive: (N,) false: dead from the start.
        target: (N,) the class that is right.
        seeds: (R,) uint64, of the random generator of each run.
        loss: share of messages lost.
        zeros: whether a lost message reads as zeros; else the last one is held.
        clocks: `(first update, period, latency)`, (N,) each, and when the first tile is switched on; None:
            the paper's sampler.
        fault: one of `FAULTS`.
        faulty: (R,) the cell with the fault, `NOBODY` for none.
        begin: first step of the fault.
        end: step at which a tile that was away is back.
    """

    starts: NDArray[Any]
    neighbours: NDArray[Any]
    alive: NDArray[np.bool_]
    target: NDArray[Any]
    seeds: NDArray[np.uint64]
    loss: float
    zeros: bool
    clocks: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float] | None
    fault: str
    faulty: NDArray[Any]
    begin: int
    end: int


def units(steps: NDArray[np.float64] | float) -> NDArray[np.int64]:
    """Times in the units of the schedule."""
    counted: NDArray[np.int64] = np.rint(np.asarray(steps) * UNITS_PER_STEP).astype(np.int64)
    return counted


def _as_c(setup: Setup) -> _CSetup:
    """The structure; it keeps the arrays that it points at."""
    first, period, latency, start = setup.clocks or (np.zeros(0), np.zeros(0), np.zeros(0), 0.0)
    arrays: dict[str, NDArray[Any]] = {
        "starts": setup.starts.astype(np.int32),
        "neighbours": np.ascontiguousarray(setup.neighbours, np.int32),
        "alive": setup.alive.astype(np.uint8),
        "target": setup.target.astype(np.int8),
        "seeds": np.ascontiguousarray(setup.seeds, np.uint64),
        "first": units(first),
        "period": units(period),
        "latency": units(latency),
        "faulty": setup.faulty.astype(np.int32),
    }
    made = _CSetup(
        runs=len(setup.seeds),
        cells=len(setup.alive),
        loss=round(setup.loss * LOSS_UNITS),
        zeros=setup.zeros,
        clocks=setup.clocks is not None,
        start=int(units(start)),
        fault=FAULTS.index(setup.fault),
        begin=setup.begin,
        end=setup.end,
        **{name: address(array) for name, array in arrays.items()},
    )
    made.arrays = arrays
    return made


class CompiledRollout:
    """Runs by the firmware's core.

    Args:
        model: its integer weights are used.
        setup: the runs.
        states: (N, C) int16, contiguous; changed in place.
        shown: (N,) int8, the class each tile shows, `DARK` for none; changed in place.

    Raises:
        BuildError: the library is not built.
        ValueError: the states are of another type.
    """

    def __init__(
        self, model: Model, setup: Setup, states: NDArray[np.int16], shown: NDArray[np.int8]
    ) -> None:
        if states.dtype != np.int16 or not states.flags.c_contiguous:
            raise ValueError(f"states are {states.dtype}, wanted: contiguous int16")
        self._runs, self._cells = len(setup.seeds), len(setup.alive)
        self._alive = _as_c(setup), states, shown  # as long as C points at them
        self._library, self._rollout = library(), None
        self._rollout = self._library.tilenca_tissue_new(
            CModel.of(model), ctypes.byref(self._alive[0]), address(states), address(shown)
        )
        if not self._rollout:
            raise MemoryError

    def __del__(self) -> None:
        if getattr(self, "_rollout", None):
            self._library.tilenca_tissue_delete(self._rollout)

    def run(self, right: NDArray[np.float32], shown: NDArray[np.int8] | None, threads: int) -> None:
        """Runs as many steps as `right` has rows.

        Args:
            right: (T, R), filled with the share of the counted tiles that are right after each step.
            shown: (T, N), filled with the class that each tile shows; None: not wanted.
            threads: how many to use; the result does not depend on it.
        """
        for array, width in ((right, self._runs), (shown, self._cells)):
            if array is not None and not (array.flags.c_contiguous and array.shape == (len(right), width)):
                raise ValueError(f"a result is {array.shape}, wanted: ({len(right)}, {width}), contiguous")
        self._library.tilenca_tissue_run(
            self._rollout, len(right), threads, address(right), None if shown is None else address(shown)
        )

    @property
    def updates(self) -> int:
        """Cell updates computed in all."""
        return int(self._library.tilenca_tissue_updates(self._rollout))


class _CTick(ctypes.Structure):
    """`TilencaRound` of tools/simulator/core_api.cpp."""

    _fields_ = (
        *((name, ctypes.POINTER(ctypes.c_int32)) for name in ("gone", "born", "arrivals", "updates")),
        *((f"{name}_count", ctypes.c_int32) for name in ("gone", "born", "arrivals", "updates")),
    )


@dataclass(frozen=True)
class Tick:
    """The events of a tick, in this order.

    Attributes:
        gone: cells that fall silent and dark.
        born: cells that are switched on again in the seed state, without any message.
        senders: (A,) cells whose current message arrives.
        arrives: (A, 4) bool, on which sides.
        updating: (U,) cells that update.
        absent: (U, 4) bool, the sides that they read as zeros.
        last: whether it is the last tick of a step.
    """

    gone: Cells
    born: Cells
    senders: Cells
    arrives: NDArray[np.bool_]
    updating: Cells
    absent: NDArray[np.bool_]
    last: bool


class TickSchedule:
    """The schedule of runs, without their states."""

    def __init__(self, setup: Setup) -> None:
        self._setup = _as_c(setup)
        self._library = library()
        self._tick = _CTick()
        self._schedule = self._library.tilenca_plan_new(ctypes.byref(self._setup))
        if not self._schedule:
            raise MemoryError

    def __del__(self) -> None:
        if getattr(self, "_schedule", None):
            self._library.tilenca_plan_delete(self._schedule)

    def next(self) -> Tick:
        """Plans the next tick."""
        last = bool(self._library.tilenca_plan_next(self._schedule, ctypes.byref(self._tick)))

        def cells(name: str, width: int) -> Cells:
            count = getattr(self._tick, f"{name}_count")
            if count == 0:
                return np.zeros((0, width), np.int32)
            return np.ctypeslib.as_array(getattr(self._tick, name), (count, width)).copy()

        senders, arrives = _events(cells("arrivals", 2))
        updating, absent = _events(cells("updates", 2))
        return Tick(cells("gone", 1)[:, 0], cells("born", 1)[:, 0], senders, arrives, updating, absent, last)


def _events(pairs: Cells) -> tuple[Cells, NDArray[np.bool_]]:
    return pairs[:, 0], (pairs[:, 1:] >> np.arange(4) & 1).astype(np.bool_)
