"""The plan of a sweep: its rows, what decides their numbers, and what travels to the workers."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.base.shipped import model_folder
from tilenca.cluster.fingerprint import fingerprint
from tilenca.evaluation.cases import SHORT_STEPS, steps_for
from tilenca.model.file import Model, load_model
from tilenca.shapes.sizes import parse_size
from tilenca.sweep.axes import AS_DRAWN, Axis, Point, points, text_of
from tilenca.sweep.measure import Luggage
from tilenca.sweep.rows import Row
from tilenca.sweep.subjects import Subjects

MAX_ROWS = 1_000_000


@dataclass(frozen=True)
class Wish:
    """What the user asked for.

    Attributes:
        axes: to vary.
        model: where there is no axis of models.
        files: the shape files.
        engine: one of `tilenca.sweep.axes.ENGINES`.
        steps: updates per tile; None: as the test suite has for the size.
        runs: of each drawing.
        seed: of all.
        only: names of drawings or labels; empty: all.
        image: the firmware's file, for emulated tiles.
    """

    axes: tuple[Axis, ...]
    model: str
    files: tuple[Path, ...]
    engine: str
    steps: int | None
    runs: int
    seed: int
    only: tuple[str, ...] = ()
    image: Path | None = None


@dataclass(frozen=True)
class Plan:
    """A sweep.

    Attributes:
        cells: the rows of each combination of conditions.
        luggage: what travels to the workers.
        identity: plain values; with the same ones the table is the same.
    """

    cells: tuple[tuple[Row, ...], ...]
    luggage: Luggage
    identity: dict[str, Any] = field(default_factory=dict)

    @property
    def rows(self) -> list[Row]:
        """The rows of all cells."""
        return [row for cell in self.cells for row in cell]


def make_plan(wish: Wish) -> Plan:
    """Lays a sweep out.

    Raises:
        UsageError: the axes do not fit the engine, a model or a file cannot be used, or it is too large.
    """
    every = [{**point, "model": point["model"] or wish.model} for point in points(wish.axes, wish.engine)]
    names = dict.fromkeys(str(point["model"]) for point in every)
    models = {name: load_model(model_folder(name)) for name in names}
    subjects = {name: Subjects(model, wish.files, wish.seed, wish.only) for name, model in models.items()}
    cells: list[tuple[Row, ...]] = []
    rows = 0
    for point in every:
        name = str(point["model"])
        cells.append(tuple(_cell(wish, point, f"{models[name].model_id:04X}", subjects[name])))
        rows += len(cells[-1])
        if rows > MAX_ROWS:
            raise UsageError(f"--axis: more than {MAX_ROWS:,} rows; give fewer values, or fewer drawings")
    luggage = Luggage(
        wish.seed, models, b"" if wish.image is None else wish.image.read_bytes(), wish.image or Path()
    )
    return Plan(tuple(cells), luggage, _identity(wish, luggage, cells, next(iter(subjects.values())).sources))


def _cell(wish: Wish, point: Point, model_id: str, subjects: Subjects) -> list[Row]:
    size = str(point["size"])
    steps = wish.steps or (SHORT_STEPS if size == AS_DRAWN else steps_for(parse_size(size)))
    return [
        Row(point, wish.engine, model_id, steps, subject, wish.runs * len(subject.shapes))
        for subject in subjects.at(str(point["drawings"]), size)
    ]


def _identity(
    wish: Wish, luggage: Luggage, cells: Sequence[Sequence[Row]], sources: Sequence[Mapping[str, str]]
) -> dict[str, Any]:
    """What decides the table, under the words of the command line."""
    return {
        **{name: what for name, what in asdict(fingerprint()).items() if name != "rollout"},  # of training
        "--engine": wish.engine,
        "--seed": wish.seed,
        "--runs": wish.runs,
        "--steps": wish.steps,
        "--axis": [[axis.name, *map(text_of, axis.values)] for axis in wish.axes],
        "--shape": list(wish.only),
        "--shapes": [dict(source) for source in sources],
        "--model": {name: digest_of(model) for name, model in luggage.models.items()},
        "firmware": hashlib.sha256(luggage.image).hexdigest()[:20] if luggage.image else None,
        "rows": sum(map(len, cells)),
    }


def digest_of(model: Model) -> str:
    """A digest of all that decides what a model does."""
    digest = hashlib.sha256(repr((model.labels, model.dimensions)).encode())
    for name in model.dimensions.shapes():
        digest.update(model.integer[name].tobytes())
    return digest.hexdigest()[:20]
