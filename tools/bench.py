"""Prints what the firmware costs and how fast it is emulated: python tools/bench.py FIRMWARE.elf."""

import argparse
import sys
import time
from pathlib import Path

import budgets
from tilenca import paths
from tilenca.emulation import Conditions, Emulation, firmware_settings
from tilenca.shapes import load_task

SHAPE = "8"  # of the paper's digits the one with the most tiles
SEED = 0


def emulation(elf: Path, seconds: float) -> list[str]:
    """Emulates a whole drawing on one core; one line per figure.

    Cycle counts are exact and the same on every machine, since the seed decides all there is to decide.

    Raises:
        TilencaError: the image cannot be emulated.
    """
    task = load_task(paths.DEFAULT_SHAPES)
    running = Emulation(
        task, task.find(SHAPE), elf, Conditions(seconds=seconds, seed=SEED), firmware_settings(elf)
    )
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
    return [
        f"{'cycles awake/update':<22} {awake / updates:>8,.0f}, all told: network, links, display, telemetry",
        f"{'share of time awake':<22} {awake / sum(total for total, _ in cycles):>8.1%}",
        f"{'frames':<22} " + ", ".join(f"{count:,} {name}" for name, count in frames.items()),
        f"{'emulation, one core':<22} {len(tiles)} tiles at {ratio:.1f} times real time, "
        f"{len(tiles) * ratio / 20:.1f} times for twenty",
    ]


def main() -> int:
    """Prints the sizes, then the speed; returns the exit status of the budgets."""
    parser = argparse.ArgumentParser(
        description="Prints what the firmware costs and how fast it is emulated."
    )
    parser.add_argument("elf", type=Path, help="the image, as .pio/build/megaatmega2560/firmware.elf")
    parser.add_argument("--seconds", type=float, default=20.0, help="emulated time (default: %(default)s)")
    args = parser.parse_args()
    status = budgets.report(args.elf)
    print("\n".join(emulation(args.elf, args.seconds)), flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
