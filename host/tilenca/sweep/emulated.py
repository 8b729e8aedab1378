"""One drawing on emulated tiles, to its end: how a run is measured, for `evaluate` and for sweeps."""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from tilenca.base.errors import BuildError
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.fault_spec import parse as parse_fault
from tilenca.model.file import Model
from tilenca.protocol.constants import DEFAULT_PERIOD_MS
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.settings import Settings
from tilenca.shapes.file import Shape
from tilenca.simulator.simulator import MIXED
from tilenca.sweep.steps import right_since

PLUGS = ("again", "new")  # how a tile is plugged in while the others run
# The others have agreed by then; what was pulled is away for long enough that all have noticed.
PLUG_BOOT_S, PULLED_S, AWAY_S = 0.2, 1.2, 0.8
START_UP_S = 0.2  # of a tile without a bootloader, at most
Look = Callable[[Emulation, list[Heard]], None]


@dataclass(frozen=True)
class Image:
    """A firmware image and the model that it must carry.

    Attributes:
        elf: the file.
        defaults: its settings, see `tilenca.emulator.greeting.firmware_settings`.
        model: the model.
        folder: of the model, for messages.
        source: the file that `elf` is a copy of, for messages; None: it is none.
    """

    elf: Path
    defaults: Settings | None
    model: Model
    folder: Path
    source: Path | None = None


@dataclass(frozen=True)
class EmulatedRun:
    """A run that ended.

    Attributes:
        right: share of the tiles with power that showed the right class at the end.
        converged_at: step from which all were right to the end, see `right_since`; infinite for none.
        agreed_s: seconds from when the last tile was switched on until all were right to the end; the same.
        answer: the class that all showed at the end, negative where they differed.
        updates: that the tiles did in all.
    """

    right: float
    converged_at: float
    agreed_s: float
    answer: int
    updates: int


def run_emulated(
    image: Image, shape: Shape, settings: EmulationSettings, look: Look = lambda emulation, heard: None
) -> EmulatedRun:
    """Runs a drawing to its end.

    Args:
        image: of all tiles.
        shape: the drawing.
        settings: of the run.
        look: called after every slice of time.

    Raises:
        BuildError: the image carries another model.
        TilencaError: a tile stopped at a fault, or does not get its updates done.
    """
    emulation = Emulation(shape, image.model.labels, image.elf, settings, image.defaults)

    def on_slice(running: Emulation, heard: list[Heard]) -> None:
        look(running, heard)
        _check_model(running, image)

    with emulation.array:
        emulation.run(on_slice)
        agreed_s = emulation.agreed_at_s()
        period_ms = emulation.period_ms or DEFAULT_PERIOD_MS
        labels = list(image.model.labels)
        answers = set(emulation.answers())
        known = len(answers) == 1 and answers <= set(labels)
        return EmulatedRun(
            emulation.share_right(),
            right_since(emulation, image.model.dimensions, period_ms),
            math.inf if agreed_s is None else agreed_s,
            labels.index(answers.pop()) if known else MIXED,
            emulation.updates_done(),
        )


def plugged(
    settings: EmulationSettings, kind: str, tiles: int, steps: int, period_ms: int
) -> EmulationSettings:
    """A run in which one tile is plugged in while the others run. Times and steps then count from there.

    Args:
        settings: of the run; the seed decides which tile it is.
        kind: "again": it ran with the others, and was pulled; "new": it was not there before.
        tiles: of the drawing, two at least.
        steps: periods after which the run is judged.
        period_ms: of an update.
    """
    tile = random.Random(f"{settings.seed} plugged").randrange(tiles) + 1
    away_s, back_s = (0.0, PULLED_S) if kind == "new" else (PULLED_S, PULLED_S + AWAY_S)
    return replace(
        settings,
        seconds=back_s + START_UP_S + (steps + 1) * period_ms / 1000,
        boot_spread_s=PLUG_BOOT_S,
        faults=(*settings.faults, parse_fault(f"off@{tile}:{away_s:g}-{back_s:g}")),
    )


def _check_model(emulation: Emulation, image: Image) -> None:
    """Refuses to measure an image that carries another model."""
    hello, model = emulation.hello, image.model
    if hello is not None and hello.model_id != model.model_id:
        raise BuildError(
            f"{image.source or image.elf}: carries model {hello.model_id:04X}, not {model.model_id:04X}; "
            f"run: tilenca export --model {image.folder} && pio run"
        )
