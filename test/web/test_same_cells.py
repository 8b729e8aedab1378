"""WebAssembly and this machine's own code compute the same cells, on every schedule."""

import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from release.web_model import model_json
from support.avr import build_target
from tilenca.base import paths
from tilenca.model.file import load_model
from tilenca.shapes.file import Shape
from tilenca.simulator.rollout_library import DARK, NOBODY, Clocks, CompiledRollout, Setup
from web.conftest import SOURCES, node

DRAWINGS = ["#.#\n#.#\n###\n..#\n..#", "####\n#..#\n####\n#..#\n####"]
STEPS = 40
SEEDS = [11, 2**52 + 5]
FAULTY = [2, 7]  # the tile of each run
NAMES = {"halves": "random", "clocks": "clock", "listing": "listing"}  # of the schedules, there and here


def native(schedule: str, clocks: dict[str, list[float]], loss: float) -> dict[str, Any]:
    """What this machine's own simulator makes of it."""
    shapes = [Shape("8", tuple(drawing.split("\n")), "8") for drawing in DRAWINGS]
    sizes = [len(shape.cells) for shape in shapes]
    starts = np.cumsum([0, *sizes])
    cells = int(starts[-1])
    neighbours = np.concatenate(
        [
            np.where(np.array(shape.neighbours()) < 0, cells, np.array(shape.neighbours()) + start)
            for shape, start in zip(shapes, starts[:-1], strict=True)
        ]
    )
    model = load_model(paths.ROOT / "models" / "digits")
    on_clocks = schedule == "clocks"
    times = [np.array(clocks[name]) for name in ("first", "period", "latency")]
    switched_on = np.floor(min(0.0, float((times[0] - times[1]).min())) * 20) / 20
    setup = Setup(
        starts, neighbours, np.ones(cells, bool), np.repeat([4, 8], sizes), np.array(SEEDS, np.uint64),
        loss, True, NAMES[schedule], Clocks(times[0], times[1], times[2], switched_on) if on_clocks else None,
        False, "stuck", np.where(np.array(FAULTY) < 0, NOBODY, FAULTY + starts[:-1]), 10, 0,
        np.zeros((0, 3), np.int32),
    )  # fmt: skip
    states = np.zeros((cells, model.dimensions.channels), np.int16)
    states[:, 0] = 8192
    shown = np.full(cells, DARK, np.int8)
    rollout = CompiledRollout(model, setup, states, shown)
    right = np.empty((STEPS, len(SEEDS)), np.float32)
    rollout.run(right, None, 1)
    return {
        "right": right.ravel().tolist(),
        "states": states.ravel().tolist(),
        "shown": shown.tolist(),
        "updates": rollout.updates,
    }


@pytest.mark.parametrize("schedule", ["halves", "clocks", "listing"])
def test_forty_steps_with_losses_and_a_fault_end_in_the_same_states(
    bundle: Path, tmp_path: Path, schedule: str
) -> None:
    build_target("tilenca_simulator")
    draw = random.Random(5)
    cells = sum(drawing.count("#") for drawing in DRAWINGS)
    clocks = {
        "first": [draw.uniform(0, 3) for _ in range(cells)],
        "period": [draw.uniform(0.99, 1.01) for _ in range(cells)],
        "latency": [draw.uniform(0.1, 0.9) for _ in range(cells)],
    }
    given = {
        "model": json.loads(model_json(load_model(paths.ROOT / "models" / "digits"))),
        "drawings": DRAWINGS,
        "steps": STEPS,
        "schedule": schedule,
        "clocks": clocks,
        "loss": 0.125,
        "zeros": True,
        "fault": "stuck",
        "begin": 10,
        "runs": [
            {"target": target, "seed": seed, "faulty": faulty}
            for target, seed, faulty in zip([4, 8], SEEDS, FAULTY, strict=True)
        ],
    }
    (tmp_path / "cells.json").write_text(json.dumps(given))
    found = json.loads(node(SOURCES / "test" / "cells.js", bundle, tmp_path / "cells.json"))
    assert found == native(schedule, clocks, 0.125)
