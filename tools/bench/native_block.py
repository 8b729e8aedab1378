"""Prints how long a block of tiles takes on this machine's own emulator: native_block.py IMAGE CASE.

The same block as web/bench/block.js runs. Uses only what every version of `tilenca.emulator` has.
"""

import json
import sys
import time

from tilenca.emulator import Array

EAST, SOUTH, WEST, NORTH = 1, 2, 3, 0
PPM, SWITCHED_ON_S = 3000.0, 0.2


def main(image: str, case: dict[str, float]) -> dict[str, float]:
    """Runs the block; {"cpuS", "wallS"} of what is measured."""
    rows, columns = int(case["rows"]), int(case["columns"])
    tiles = rows * columns
    across = [(i, EAST, i + 1, WEST) for i in range(tiles) if i % columns != columns - 1]
    down = [(i, SOUTH, i + columns, NORTH) for i in range(tiles - columns)]
    ppm = [PPM * (i * 7 % tiles / (tiles / 2) - 1) for i in range(tiles)]
    switch_on_s = [SWITCHED_ON_S * (i * 3 % tiles) / tiles for i in range(tiles)]
    array = Array(image, tiles, across + down, ppm, switch_on_s)
    if not case["translated"] and getattr(array, "is_translated", False):
        array = Array(image, tiles, across + down, ppm, switch_on_s, translated=False)
    array.run(case["warmUpS"])
    cpu_s, wall_s = time.process_time(), time.perf_counter()
    array.run(case["measuredS"])
    return {"cpuS": time.process_time() - cpu_s, "wallS": time.perf_counter() - wall_s}


if __name__ == "__main__":
    print(json.dumps(main(sys.argv[1], json.loads(sys.argv[2]))))
