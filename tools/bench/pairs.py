"""Runs done twice: by emulated tiles with the real firmware, and by the simulator with the times of tiles.

The drawing, the clocks and the moments of power are the same. What is left between the two is what the
simulator does not know. `bench.gap` and `bench.unseen` tell of such pairs.
"""

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tilenca.base import paths
from tilenca.base.processors import processors
from tilenca.commands.origin import own_shapes
from tilenca.commands.own_firmware import image_to_write
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.side_by_side import run_side_by_side
from tilenca.fleet.build import build
from tilenca.model.file import Model, load_model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.protocol.line_reader import Heard
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.simulator.chance import NO_SWITCHES
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.rollout_library import DARK, NOBODY, Clocks, CompiledRollout, Setup
from tilenca.simulator.simulator import Trajectory
from tilenca.simulator.tile_times import TileTimes, tile_times
from tilenca.sweep.emulated import Image, run_emulated
from tilenca.sweep.steps import clock_rates, first_updates_ms
from tilenca.views.progress import show_progress

STEPS = 31
SEEDS = 1_000_000  # from one seed of the benchmark to the next
DEVIATIONS = 1.96  # either way, of a 95 % interval
RULE_OF_THREE = 3.0  # what was not seen in N runs happens in 3 / N of them at most, at 95 %

Steps = NDArray[np.float64]


@dataclass(frozen=True)
class EmulatedTiles:
    """A run of N emulated tiles.

    Attributes:
        drawing: its number.
        ppm: (N,) the errors of their clocks.
        switch_on_s: (N,) when each got power.
        converged_at: the step from which all tiles stay right, infinite for none; see `tilenca.sweep.steps`.
    """

    drawing: int
    ppm: tuple[float, ...]
    switch_on_s: tuple[float, ...]
    converged_at: float


@dataclass(frozen=True)
class Pairs:
    """R runs done twice.

    Attributes:
        tiles: (R,) the step from which all emulated tiles stay right, infinite for none.
        simulator: (R,) the same of the simulator's.
    """

    tiles: Steps
    simulator: Steps

    @property
    def same(self) -> float:
        """The share of pairs that agree at the same update."""
        return float(np.mean(self.tiles == self.simulator))

    @property
    def near(self) -> float:
        """The share of pairs that agree at most one update apart."""
        with np.errstate(invalid="ignore"):  # where neither agrees
            apart = np.abs(self.tiles - self.simulator)
        return float(np.mean((self.tiles == self.simulator) | (apart <= 1)))

    def gap(self, update: int) -> tuple[float, float]:
        """The share of runs that stay right from an update on or earlier, the tiles' less the simulator's.

        Returns:
            The gap, and how far its 95 % interval reaches to either side: at least as far as if no pair
            differed, since R pairs do not tell more.
        """
        each = (self.tiles <= update).astype(float) - (self.simulator <= update)
        half = DEVIATIONS * each.std() / len(each) ** 0.5
        return float(each.mean()), float(max(half, RULE_OF_THREE / len(each)))


def image_with(folder: Path) -> Image:
    """The firmware of a model, brought up to date: the project's own for the digits.

    Raises:
        BuildError: it cannot be built.
    """
    if folder.resolve() == paths.DEFAULT_MODEL.resolve():
        build(quiet=True)
        elf = paths.FIRMWARE_ELF
    else:
        elf = image_to_write(folder)
    return Image(elf, firmware_settings(elf), load_model(folder), folder)


def drawings_of(image: Image) -> Drawings:
    """The first of the files that a model was trained on."""
    return load_drawings(own_shapes(image.model, image.folder)[:1], labels=image.model.labels)


def period_of(image: Image) -> float:
    """Of an update."""
    return image.defaults.period_ms if image.defaults else DEFAULT_PERIOD_MS


def emulate(
    image: Image, drawings: Drawings, runs: int, seed: int, steps: int = STEPS
) -> list[EmulatedTiles]:
    """Runs emulated tiles, as many runs at once as there are processors; shows its progress.

    Args:
        image: of the firmware.
        drawings: they take turns.
        runs: how many.
        seed: of the benchmark.
        steps: updates of a run.

    Raises:
        TilencaError: the image has another model, or a tile stopped at a fault.
    """

    def run(number: int, stopped: threading.Event) -> EmulatedTiles:
        drawing = number % len(drawings)
        clocks: dict[str, tuple[float, ...]] = {}

        def look(running: Emulation, _: list[Heard]) -> None:
            if stopped.is_set():
                raise KeyboardInterrupt
            clocks.update(ppm=tuple(running.ppm), switch_on_s=tuple(running.switch_on_s))

        settings = EmulationSettings(updates=steps, seed=seed * SEEDS + number)
        done = run_emulated(image, drawings.shapes[drawing], settings, look)
        return EmulatedTiles(drawing, **clocks, converged_at=done.converged_at)

    done = []
    with show_progress() as tell:
        for number, result in run_side_by_side(run, range(runs)):
            done.append(result)
            tell(image.folder.name, (number + 1) / runs, f"run {number + 1} of {runs}")
    return done


def simulate(
    model: Model,
    drawings: Drawings,
    tiles: Sequence[EmulatedTiles],
    times: TileTimes,
    period_ms: float,
    steps: int = STEPS,
) -> Steps:
    """The same runs in the simulator; (R,) the step from which each stays right, infinite for none.

    Args:
        model: that the tiles have.
        drawings: those of the runs.
        tiles: R runs.
        times: of tiles.
        period_ms: of an update.
        steps: updates of a run.
    """
    batch = drawings.batch(np.array([run.drawing for run in tiles]))
    cells, runs = len(batch.sample), len(tiles)
    clocks = _clocks(tiles, times, period_ms, batch.starts, (batch.neighbours < cells).sum(axis=1))
    setup = Setup(
        starts=np.append(batch.starts, cells),
        neighbours=batch.neighbours,
        alive=np.ones(cells, np.bool_),
        target=batch.target,
        seeds=np.arange(runs, dtype=np.uint64),  # nothing is left to chance
        loss=0.0,
        zeros=False,
        schedule="clock",
        clocks=clocks,
        running=False,
        fault="none",
        faulty=np.full(runs, NOBODY),
        begin=0,
        end=0,
        changes=NO_SWITCHES,
    )
    states, shown = FastEngine(model).seed(cells), np.full(cells, DARK, np.int8)
    right = np.empty((steps, runs), np.float32)
    CompiledRollout(model, setup, states, shown).run(right, None, processors())
    return Trajectory(right).converged_at


def _clocks(
    tiles: Sequence[EmulatedTiles],
    times: TileTimes,
    period_ms: float,
    starts: NDArray[np.int64],
    neighbours: NDArray[np.int64],
) -> Clocks:
    """The clocks that the emulated tiles had. The first step ends with the last tile's first update."""
    ppm, switch_on_s = (np.concatenate([getattr(run, of) for run in tiles]) for of in ("ppm", "switch_on_s"))
    rate = clock_rates(ppm)
    first = first_updates_ms(rate, switch_on_s) / period_ms
    sizes = np.diff(np.append(starts, len(first)))
    first += 1 - times.ends - np.repeat(np.maximum.reduceat(first, starts), sizes)
    made = times.clocks(1 / rate, neighbours)
    start = float(np.floor((first - made.period).min()))
    return Clocks(first, made.period, made.latency, start, made.seed_latency, made.line)


def run_pairs(image: Image, drawings: Drawings, runs: int, seed: int, steps: int = STEPS) -> Pairs:
    """Does all runs twice; see `emulate`."""
    period = period_of(image)
    tiles = emulate(image, drawings, runs, seed, steps)
    times = tile_times(image.model.dimensions, period)
    simulator = simulate(image.model, drawings, tiles, times, period, steps)
    return Pairs(np.array([run.converged_at for run in tiles]), simulator)
