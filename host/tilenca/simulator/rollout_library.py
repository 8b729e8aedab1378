"""Compiled rollouts of a batch of grids (tools/simulator): the schedule, the messages and the updates.

`CompiledRollout` computes all of it with the firmware's core. `TickSchedule` only gives the events of each
tick, for engines that compute other states; both follow the same schedule, number by number.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.base.sides import SIDES
from tilenca.model.file import Model
from tilenca.simulator.core_library import library, model_struct, pointer

TICKS_PER_STEP = 20  # TILENCA_TICKS of simulator.h: the resolution of a step on clocks
UNITS_PER_STEP = TICKS_PER_STEP << 16  # TILENCA_UNITS_PER_TICK
LOSS_UNITS = 1 << 32
DARK = -1
SCHEDULES = ("random", "clock", "listing")  # TILENCA_SCHEDULE_... in their order
FAULTS = ("none", "dead", "stuck", "away")  # TILENCA_FAULT_... in their order
NOBODY = -1

Cells = NDArray[np.int32]


@dataclass(frozen=True)
class Clocks:
    """The clocks of N tiles, in steps.

    Attributes:
        first: (N,) when each updates for the first time. It is switched on one period before that.
        period: (N,) from update to update.
        latency: (N, 4) by the side that a message leaves from, or (N,) for all sides: from the moment at
            which an update reads the neighbours' messages to that at which a neighbour can read its result.
        start: when the first tile is switched on, from -1,000,000 to 0, a whole number of ticks.
        seed_latency: as `latency`, of the seed state, from the moment at which the tile is switched on;
            None: as `latency`.
        line: (4,) by the same side, how long a message is on its line before it arrives: a tile that is
            switched on meanwhile does not hear it. None: no time.
    """

    first: NDArray[np.float64]
    period: NDArray[np.float64]
    latency: NDArray[np.float64]
    start: float
    seed_latency: NDArray[np.float64] | None = None
    line: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Setup:
    """R runs of N cells in all, and their conditions.

    Attributes:
        starts: (R + 1,) the first cell of each run, and N.
        neighbours: (N, 4) N, E, S, W; N for none.
        alive: (N,) false: not there at the start.
        target: (N,) the class that is right.
        seeds: (R,) uint64, of the random generator of each run.
        loss: share of messages lost.
        zeros: whether a lost message reads as zeros; else the last one is held.
        schedule: one of `SCHEDULES`, see `tilenca.simulator.simulator.Conditions`.
        clocks: of the schedule "clock"; None for the others.
        running: whether all tiles run already, and their neighbours have their messages.
        fault: one of `FAULTS`.
        faulty: (R,) the cell with the fault, `NOBODY` for none.
        begin: first step of the fault.
        end: step at which a tile that was away is back.
        changes: (K, 3) int32, step, cell and whether it is put down (1) or taken away (0), by their steps.
    """

    starts: NDArray[Any]
    neighbours: NDArray[Any]
    alive: NDArray[np.bool_]
    target: NDArray[Any]
    seeds: NDArray[np.uint64]
    loss: float
    zeros: bool
    schedule: str
    clocks: Clocks | None
    running: bool
    fault: str
    faulty: NDArray[Any]
    begin: int
    end: int
    changes: NDArray[np.int32]


def units(steps: NDArray[np.float64] | float) -> NDArray[np.int64]:
    """Times in the units of the schedule."""
    counted: NDArray[np.int64] = np.rint(np.asarray(steps) * UNITS_PER_STEP).astype(np.int64)
    return counted


def each_side(latency: NDArray[np.float64]) -> NDArray[np.int64]:
    """(N, 4) latencies of N tiles in the units of the schedule, from one of each side or one of each tile."""
    columns = latency if latency.ndim == 2 else latency[:, None]
    return np.ascontiguousarray(np.broadcast_to(units(columns), (len(latency), len(SIDES))))


def _setup_struct(setup: Setup) -> tuple[Any, list[Any]]:
    """The setup as `tilenca_setup`, and what must live as long as that."""
    none = np.zeros(0)
    clocks = setup.clocks or Clocks(none, none, none, 0.0)
    arrays = {
        "starts": pointer(setup.starts.astype(np.int32), "int32_t"),
        "neighbours": pointer(np.ascontiguousarray(setup.neighbours, np.int32), "int32_t"),
        "alive": pointer(setup.alive.astype(np.uint8), "uint8_t"),
        "target": pointer(setup.target.astype(np.int8), "int8_t"),
        "seeds": pointer(np.ascontiguousarray(setup.seeds, np.uint64), "uint64_t"),
        "first": pointer(units(clocks.first), "int64_t"),
        "period": pointer(units(clocks.period), "int64_t"),
        "latency": pointer(each_side(clocks.latency), "int64_t"),
        "faulty": pointer(setup.faulty.astype(np.int32), "int32_t"),
        "changes": pointer(np.ascontiguousarray(setup.changes, np.int32), "tilenca_change"),
    }
    if clocks.seed_latency is not None:
        arrays["seed_latency"] = pointer(each_side(clocks.seed_latency), "int64_t")
    if clocks.line is not None:
        arrays["line"] = pointer(units(clocks.line), "int64_t")
    numbers = {
        "runs": len(setup.seeds),
        "cells": len(setup.alive),
        "loss": round(setup.loss * LOSS_UNITS),
        "zeros": setup.zeros,
        "schedule": SCHEDULES.index(setup.schedule),
        "running": setup.running,
        "start": int(units(clocks.start)),
        "fault": FAULTS.index(setup.fault),
        "begin": setup.begin,
        "end": setup.end,
        "changes_count": len(setup.changes),
    }
    return library().ffi.new("tilenca_setup*", numbers | arrays), list(arrays.values())


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
        given, arrays = _setup_struct(setup)
        network, _weights = model_struct(model)
        cells = pointer(states, "int16_t"), pointer(shown, "int8_t")
        self._alive = arrays, cells  # as long as C points at them
        self._batch = library().call("grid_batch_new", network, given, *cells)

    def __del__(self) -> None:
        if hasattr(self, "_batch"):
            library().call("grid_batch_free", self._batch)

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
        trajectory = library().ffi.NULL if shown is None else pointer(shown, "int8_t")
        library().call(
            "grid_batch_run", self._batch, len(right), threads, pointer(right, "float"), trajectory
        )

    @property
    def updates(self) -> int:
        """Cell updates computed in all."""
        return int(library().call("grid_batch_updates", self._batch))


@dataclass(frozen=True)
class Tick:
    """The events of a tick, in this order.

    Attributes:
        gone: cells that fall silent and dark.
        born: cells that are switched on in the seed state, without any message.
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
        given, self._alive = _setup_struct(setup)
        self._tick = library().ffi.new("tilenca_tick*")
        self._schedule = library().call("schedule_new", given)

    def __del__(self) -> None:
        if hasattr(self, "_schedule"):
            library().call("schedule_free", self._schedule)

    def next(self) -> Tick:
        """Plans the next tick."""
        last = bool(library().call("schedule_next", self._schedule, self._tick))
        senders, arrives = _events(self._cells("deliveries", 2))
        updating, absent = _events(self._cells("updates", 2))
        gone, born = self._cells("switched_off", 1)[:, 0], self._cells("switched_on", 1)[:, 0]
        return Tick(gone, born, senders, arrives, updating, absent, last)

    def _cells(self, name: str, width: int) -> Cells:
        """A list of the tick as (its length, width)."""
        count = getattr(self._tick, f"{name}_count")
        if count == 0:
            return np.zeros((0, width), np.int32)
        memory = library().ffi.buffer(getattr(self._tick, name), 4 * width * count)
        return np.frombuffer(memory, np.int32).reshape(count, width).copy()


def _events(pairs: Cells) -> tuple[Cells, NDArray[np.bool_]]:
    return pairs[:, 0], (pairs[:, 1:] >> np.arange(4) & 1).astype(np.bool_)
