"""One drawing on emulated tiles, to its end: how a run is measured, for `evaluate` and for sweeps."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import BuildError
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.model.file import Model
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.settings import Settings
from tilenca.shapes.file import Shape
from tilenca.simulator.simulator import MIXED

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
        converged_at: update from which all were right to the end; infinite for none.
        answer: the class that all showed at the end, negative where they differed.
        updates: that the tiles did in all.
    """

    right: float
    converged_at: float
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
        at = emulation.agreed_at_update()
        labels = list(image.model.labels)
        answers = set(emulation.answers())
        known = len(answers) == 1 and answers <= set(labels)
        return EmulatedRun(
            emulation.share_right(),
            math.inf if at is None else max(at, 1),
            labels.index(answers.pop()) if known else MIXED,
            emulation.updates_done(),
        )


def _check_model(emulation: Emulation, image: Image) -> None:
    """Refuses to measure an image that carries another model."""
    hello, model = emulation.hello, image.model
    if hello is not None and hello.model_id != model.model_id:
        raise BuildError(
            f"{image.source or image.elf}: carries model {hello.model_id:04X}, not {model.model_id:04X}; "
            f"run: tilenca export --model {image.folder} && pio run"
        )
