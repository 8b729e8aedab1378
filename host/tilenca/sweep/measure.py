"""What a worker does: runs blocks on the fast simulator or on emulated tiles, and counts."""

import random as python_random
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from tilenca.emulator.experiment import EmulationSettings
from tilenca.emulator.fault_spec import FaultSpec
from tilenca.emulator.fault_spec import parse as parse_fault
from tilenca.emulator.greeting import firmware_settings
from tilenca.emulator.library import library as emulator_library
from tilenca.model.cost import frame_bytes
from tilenca.model.file import Model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.protocol.settings import Settings
from tilenca.shapes.batch import Drawings
from tilenca.shapes.file import UNKNOWN
from tilenca.simulator import core_library
from tilenca.simulator.conditions import Conditions, Fault, latency_of
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator
from tilenca.sweep.axes import FAST, STEP_S, Point
from tilenca.sweep.counts import Counts
from tilenca.sweep.emulated import Image, run_emulated
from tilenca.sweep.rows import Block, Row

STUCK_AFTER = 5  # steps, as in the test suite


@dataclass(frozen=True)
class Luggage:
    """What travels once to every worker.

    Attributes:
        seed: of the sweep.
        models: by their names on the axis `model`.
        image: the firmware's ELF; empty without emulated tiles.
        source: where that comes from, for messages.
    """

    seed: int
    models: Mapping[str, Model]
    image: bytes = b""
    source: Path = Path()


@dataclass(frozen=True)
class Measured:
    """The results of a task: counts by the blocks' keys, and the seconds of processor time it took."""

    counts: dict[str, Counts]
    cpu_s: float


def measure_blocks(luggage: Luggage, blocks: Sequence[Block]) -> Measured:
    """Runs blocks.

    Raises:
        BuildError: a library is not built, or the image carries another model.
        TilencaError: an emulated tile stopped at a fault.
    """
    started = time.thread_time()
    counts = {
        block.key: (_simulate if block.row.engine == FAST else _emulate)(luggage, block) for block in blocks
    }
    return Measured(counts, time.thread_time() - started)


def check_simulator() -> None:
    """Loads what the fast simulator needs, or says what is missing."""
    core_library.library()


def check_emulator() -> None:
    """Loads what emulated tiles need, or says what is missing."""
    emulator_library()


def message_loss(point: Point, channels: int) -> float:
    """The share of messages that do not arrive, of those lost and those with an inverted bit.

    The checksum refuses a frame with an inverted bit. A frame also goes with the delimiter before it.
    """
    bits = 8 * (frame_bytes(channels) + 1)
    return 1 - (1 - float(point["loss"])) * (1 - float(point["flip"])) ** bits


def _unknown(model: Model) -> int | None:
    return model.labels.index(UNKNOWN) if UNKNOWN in model.labels else None


def _drawings(row: Row, model: Model) -> Drawings:
    shapes = row.subject.shapes
    return Drawings(shapes, (0,) * len(shapes), model.labels, ({"file": row.subject.file, "sha256": ""},))


def _simulate(luggage: Luggage, block: Block) -> Counts:
    row, point = block.row, block.row.point
    model = luggage.models[str(point["model"])]
    random = np.random.default_rng(block.seed(luggage.seed))
    drawings, chosen = _drawings(row, model), np.array(block.drawings())
    sizes = drawings.sizes[chosen]
    conditions = Conditions(
        point["schedule"],  # type: ignore[arg-type]  # the axis has checked the words
        loss=message_loss(point, model.dimensions.channels),
        lost=point["lost"],  # type: ignore[arg-type]
        dead=float(point["dead"]),
        drift=float(point["ppm"]) * 1e-6,
        latency=latency_of(str(point["latency"]), model.dimensions, DEFAULT_PERIOD_MS),
        boot=float(point["boot-spread"]) / STEP_S,
        fault=Fault("stuck", random.integers(sizes), STUCK_AFTER) if point["stuck"] else None,
    )
    simulator = Simulator(FastEngine(model), drawings, chosen, conditions, random, threads=1)
    trajectory = simulator.run(row.steps)
    target = model.labels.index(row.subject.label)
    return Counts.of(
        trajectory.right[-1],
        trajectory.converged_at,
        simulator.answers(),
        target,
        _unknown(model),
        simulator.updates,
    )


def _emulate(luggage: Luggage, block: Block) -> Counts:
    row = block.row
    model = luggage.models[str(row.point["model"])]
    elf, defaults = _image_file(luggage.image)
    image = Image(elf, defaults, model, Path(str(row.point["model"])), luggage.source)
    seed = block.seed(luggage.seed)
    results = []
    for place, number in enumerate(block.drawings()):
        shape = row.subject.shapes[number]
        settings = EmulationSettings(
            updates=row.steps,
            ppm=float(row.point["ppm"]),
            boot_spread_s=float(row.point["boot-spread"]),
            seed=(seed + place) % 2**63,
            faults=tuple(faults(row.point, model.dimensions.channels, len(shape.cells), seed + place)),
        )
        results.append(run_emulated(image, shape, settings))
    return Counts.of(
        np.array([result.right for result in results]),
        np.array([result.converged_at for result in results], np.float64),
        np.array([result.answer for result in results]),
        model.labels.index(row.subject.label),
        _unknown(model),
        sum(result.updates for result in results),
    )


def faults(point: Point, channels: int, tiles: int, seed: int) -> list[FaultSpec]:
    """The conditions of a row as faults of emulated tiles and cables.

    Args:
        point: of the row.
        channels: of the model: a frame is lost where one of its bytes is.
        tiles: how many.
        seed: decides which are dead; one stays alive.
    """
    # A frame arrives whole when its bytes do, and the delimiter before it.
    loss = 1 - (1 - float(point["loss"])) ** (1 / (frame_bytes(channels) + 1))
    given = [
        (kind, value)
        for kind, value in (("loss", loss), ("flip", point["flip"]), ("delay", point["delay"]))
        if value
    ]
    draws = python_random.Random(f"{seed} dead")
    luck = [draws.random() for _ in range(tiles)]
    dead = [tile for tile in range(tiles) if luck[tile] < float(point["dead"]) and luck[tile] < max(luck)]
    texts = [f"{kind}={value!r}" for kind, value in given] + [f"off@{tile + 1}" for tile in dead]
    return [parse_fault(text) for text in texts]


@cache
def _image_file(image: bytes) -> tuple[Path, Settings | None]:
    """The image as a file, for as long as this process runs, and its settings."""
    folder = tempfile.TemporaryDirectory(prefix="tilenca-")
    _kept.append(folder)
    path = Path(folder.name) / "firmware.elf"
    path.write_bytes(image)
    return path, firmware_settings(path)


_kept: list["tempfile.TemporaryDirectory[str]"] = []  # removed when the process ends
