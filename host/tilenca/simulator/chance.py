"""Draws everything that chance decides about runs, before they begin."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tilenca.shapes.batch import Batch
from tilenca.simulator.conditions import Conditions, Fault, Rebuilding, Switches
from tilenca.simulator.rollout_library import NOBODY, Clocks, Setup
from tilenca.simulator.tile_times import TileTimes

NO_SWITCHES: Switches = np.zeros((0, 3), np.int32)


def draw_setup(
    batch: Batch,
    conditions: Conditions,
    random: np.random.Generator,
    running: bool,
    rebuilding: Rebuilding | None,
) -> Setup:
    """Draws everything that chance decides, before the runs begin."""
    fault = conditions.fault
    alive = _draw_alive(batch, conditions.dead, random)
    if rebuilding is not None:
        alive &= rebuilding.present
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
        schedule=conditions.schedule,
        clocks=_draw_clocks(batch, conditions, random, running) if conditions.schedule == "clock" else None,
        running=running,
        fault=fault.kind if fault else "none",
        faulty=faulty,
        begin=fault.begin if fault else 0,
        end=(fault.end or 0) if fault else 0,
        changes=NO_SWITCHES if rebuilding is None else rebuilding.switches,
    )


def _draw_alive(batch: Batch, dead: float, random: np.random.Generator) -> NDArray[np.bool_]:
    draws = random.random(len(batch.sample))
    # At least one tile of every run stays alive, so that one is left to count.
    luckiest = np.maximum.reduceat(draws, batch.starts)[batch.sample]
    alive: NDArray[np.bool_] = (draws >= dead) | (draws == luckiest)
    return alive


def _draw_clocks(batch: Batch, conditions: Conditions, random: np.random.Generator, running: bool) -> Clocks:
    """The clocks of every cell."""
    cells, times = len(batch.sample), conditions.latency
    period = 1 + random.uniform(-conditions.drift, conditions.drift, cells)
    if isinstance(times, TileTimes):
        clocks = times.clocks(period, (batch.neighbours < cells).sum(axis=1))
        ends = times.ends
    else:
        clocks, ends = Clocks(period, period, random.uniform(*times, cells), 0.0), 0.0
    if running:
        return replace(clocks, first=period * random.random(cells))
    boot = random.uniform(0, conditions.boot, cells)
    boot -= np.maximum.reduceat(boot, batch.starts)[batch.sample]
    return replace(clocks, first=boot + period - ends, start=-np.ceil(conditions.boot + ends))


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
