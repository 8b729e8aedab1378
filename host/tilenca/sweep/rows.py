"""The rows of a sweep's table, and the blocks of runs that each is measured in.

A block's chance comes from the seed of the sweep, the row and the number of the block, and from nothing else:
its result is the same wherever and whenever it runs, whatever else the sweep has.
"""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from tilenca.shapes.file import Shape
from tilenca.sweep.axes import AXES, FAST, STEP_S, Point, text_of

LATER = ("latency",)  # axes that came later: rows that do not vary them keep their chance
BLOCK_UPDATES = 1_000_000  # cell updates of a block of the fast simulator: less than a second
FAST_UPDATES = 1.5e6  # cell updates a second, and emulated tile seconds a second: only to size tasks
EMULATED_TILES = 60.0


@dataclass(frozen=True)
class Subject:
    """The drawings of a row.

    Attributes:
        name: of the drawing, or the label of several.
        file: they come from.
        shapes: the drawings, of one label; run number n has drawing n modulo their number.
    """

    name: str
    file: str
    shapes: tuple[Shape, ...]

    @property
    def label(self) -> str:
        """The class that is right."""
        return self.shapes[0].label

    @property
    def tiles(self) -> float:
        """Tiles of a drawing, on average."""
        return sum(len(shape.cells) for shape in self.shapes) / len(self.shapes)


@dataclass(frozen=True, eq=False)
class Row:
    """A row of the table.

    Attributes:
        point: a value for every axis that the engine has.
        engine: one of `tilenca.sweep.axes.ENGINES`.
        model_id: of the model.
        steps: updates per tile.
        subject: the drawings.
        runs: of all its drawings.
    """

    point: Point
    engine: str
    model_id: str
    steps: int
    subject: Subject
    runs: int

    @cached_property
    def key(self) -> str:
        """A digest of what decides the row's chance: the conditions and drawings, not the number of runs."""
        usual = {name: AXES[name].default.get(self.engine) for name in LATER}
        conditions = {
            name: text_of(value)
            for name, value in self.point.items()
            if name != "model" and not (name in LATER and value == usual[name])
        }
        about = [conditions, self.engine, self.model_id, self.steps]
        drawings = [(shape.label, shape.rows) for shape in self.subject.shapes]
        return hashlib.sha256(json.dumps([about, drawings], sort_keys=True).encode()).hexdigest()[:20]

    @property
    def block_runs(self) -> int:
        """Runs of each block but the last."""
        if self.engine != FAST:
            return 1
        steps = self.steps + float(self.point["boot-spread"]) / STEP_S
        return max(1, int(BLOCK_UPDATES // (self.subject.tiles * steps)))

    def blocks(self) -> Iterator["Block"]:
        """The blocks, in order."""
        for number, first in enumerate(range(0, self.runs, self.block_runs)):
            yield Block(self, number, first, min(self.block_runs, self.runs - first))


@dataclass(frozen=True, eq=False)
class Block:
    """Some runs of a row, which are computed together.

    Attributes:
        row: the row.
        number: which block of the row.
        first: the number of its first run.
        runs: how many.
    """

    row: Row
    number: int
    first: int
    runs: int

    @property
    def key(self) -> str:
        """Names the block in a journal."""
        return f"{self.row.key}/{self.number}/{self.runs}"

    def seed(self, sweep_seed: int) -> int:
        """The seed of its random generator, 0 to 2^128 - 1."""
        text = f"{sweep_seed} {self.row.key} {self.number}"
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:16], "big")

    def drawings(self) -> list[int]:
        """The number of each run's drawing."""
        return [run % len(self.row.subject.shapes) for run in range(self.first, self.first + self.runs)]

    @property
    def cost_s(self) -> float:
        """Roughly how long it takes."""
        boot_s = float(self.row.point["boot-spread"])
        if self.row.engine == FAST:
            return self.runs * self.row.subject.tiles * (self.row.steps + boot_s / STEP_S) / FAST_UPDATES
        return self.runs * self.row.subject.tiles * (self.row.steps * STEP_S + boot_s) / EMULATED_TILES


def tasks_of(blocks: list[Block], task_s: float) -> list[list[Block]]:
    """Blocks grouped into tasks of about so many seconds; how they are grouped changes no result."""
    tasks: list[list[Block]] = []
    room_s = 0.0
    for block in blocks:
        if not tasks or room_s < block.cost_s / 2:
            tasks.append([])
            room_s = task_s
        tasks[-1].append(block)
        room_s -= block.cost_s
    return tasks
