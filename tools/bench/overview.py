"""Prints the firmware's costs, and the speed of its emulation and simulation: bench.overview FIRMWARE.elf."""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from bench.figures import exact, note, of_rounds
from firmware import budgets
from tilenca.base import paths
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings
from tilenca.shapes.file import load_task
from tilenca.simulator import core_library
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator

SHAPE = "8"  # of the paper's digits the one with the most tiles
SEED = 0
RUNS, SIMULATED_STEPS, TURNS = 20, 60, 5  # of the simulator


def emulation(elf: Path, seconds: float) -> list[str]:
    """Emulates a whole drawing on one core; one line per figure.

    Cycle counts are exact and the same on every machine, since the seed decides everything.

    Raises:
        TilencaError: the image cannot be emulated.
    """
    task = load_task(paths.DEFAULT_SHAPES)
    settings = EmulationSettings(seconds=seconds, seed=SEED)
    running = Emulation(task.find(SHAPE), task.labels, elf, settings, firmware_settings(elf))
    with running.array:
        started_s = time.perf_counter()
        running.run(lambda *_: None)
        wall_s = time.perf_counter() - started_s
        tiles = running.report(wall_s)["tiles"]
        cycles = [tile.cycles for tile in running.array]
    awake = sum(total - asleep for total, asleep in cycles)
    updates = sum(tile["updates"] for tile in tiles)
    frames = {name: sum(tile["frames"][name] for tile in tiles) for name in tiles[0]["frames"]}
    ratio = seconds / wall_s
    note(
        exact(f"firmware: an {SHAPE} for {seconds:.0f} s, awake", awake / updates, "cycles an update"),
        exact(f"firmware: an {SHAPE} for {seconds:.0f} s, frames lost", frames["lost"], "frames"),
        exact(f"firmware: an {SHAPE} for {seconds:.0f} s, frames damaged", frames["corrupt"], "frames"),
    )
    return [
        f"{'cycles awake/update':<22} {awake / updates:>8,.0f}, all told: network, links, display, telemetry",
        f"{'share of time awake':<22} {awake / sum(total for total, _ in cycles):>8.1%}",
        f"{'frames':<22} " + ", ".join(f"{count:,} {name}" for name, count in frames.items()),
        f"{'emulation, one core':<22} {len(tiles)} tiles at {ratio:.1f} times real time, "
        f"{len(tiles) * ratio / 20:.1f} times for twenty",
    ]


def simulator() -> list[str]:
    """Simulates all shipped digits on one core, in turn with the chip's own code on one cell after the other.

    Processor time, so that other load on this machine counts little.
    """
    model = load_model(paths.DEFAULT_MODEL)
    drawings = load_drawings(sorted(paths.SHAPES.glob("digits*.toml")), labels=model.labels)
    chosen = np.repeat(np.arange(len(drawings)), RUNS)
    whole, alone = [], []
    for turn in range(TURNS):
        random = np.random.default_rng(turn)
        simulator = Simulator(
            FastEngine(model), drawings, chosen, Conditions("clock", loss=0.1), random, threads=1
        )
        started_s = time.process_time()
        simulator.run(SIMULATED_STEPS)
        whole.append(simulator.updates / (time.process_time() - started_s))
        inputs = np.tile(FastEngine(model).message(simulator.states), 5)
        started_s = time.process_time()
        core_library.update_cells(model, simulator.states, inputs, lanes=1)
        alone.append(simulator.cells / (time.process_time() - started_s))
    speed, ratio = np.median(whole), np.median(np.divide(whole, alone))
    ratios = np.divide(whole, alone).tolist()
    note(of_rounds("simulator: against the chip's code alone", ratios, "times as fast"))
    return [
        f"{'simulation, one core':<22} {speed / 1e6:.1f} million cell updates/s with clocks, links and loss, "
        f"{ratio:.1f} times the chip's code alone"
    ]


def note_budget(finding: budgets.Finding) -> None:
    """Keeps the number of a budget."""
    if finding.value is not None:
        note(exact(f"firmware: {finding.name}", *finding.value))


def main() -> int:
    """Prints the sizes, then the speed; returns the exit status of the budgets."""
    parser = argparse.ArgumentParser(
        description="Prints what the firmware costs and how fast it is emulated and simulated."
    )
    parser.add_argument("elf", type=Path, help="the image, as .pio/build/megaatmega2560/firmware.elf")
    parser.add_argument("--seconds", type=float, default=20.0, help="emulated time (default: %(default)s)")
    args = parser.parse_args()
    status = budgets.report(args.elf, note_budget)
    print("\n".join(emulation(args.elf, args.seconds)), flush=True)
    print("\n".join(simulator()), flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
