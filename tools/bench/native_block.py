"""Prints how long some tiles take on this machine's own emulator: native_block.py IMAGE CASE.

The same block as web/bench/block.js runs, or the tiles of `grid`, lines of `#` and `.`. Uses only what every
version of `tilenca.emulator` has.
"""

import json
import sys
import time
from typing import Any

from tilenca.emulator import Array

EAST, SOUTH, WEST, NORTH = 1, 2, 3, 0
PPM, SWITCHED_ON_S = 3000.0, 0.2


def main(image: str, case: dict[str, Any]) -> dict[str, float]:
    """Runs the tiles; {"cpuS", "wallS"} of what is measured."""
    grid = case.get("grid") or "\n".join(["#" * int(case["columns"])] * int(case["rows"]))
    lines = [(row, line) for row, line in enumerate(grid.split("\n"))]
    cells = [(row, column) for row, line in lines for column, sign in enumerate(line) if sign == "#"]
    number, tiles = {cell: i for i, cell in enumerate(cells)}, len(cells)
    across = [(i, EAST, number[r, c + 1], WEST) for (r, c), i in number.items() if (r, c + 1) in number]
    down = [(i, SOUTH, number[r + 1, c], NORTH) for (r, c), i in number.items() if (r + 1, c) in number]
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
