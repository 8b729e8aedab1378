"""The emulated tiles of the model that a page has chosen; its firmware is built first where there is none."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import TilencaError, UsageError
from tilenca.emulator.greeting import firmware_settings
from tilenca.page.emulated import EmulatedSource
from tilenca.page.offer import Offer
from tilenca.protocol.stream import StreamEvent, stream_event
from tilenca.protocol.stream_commands import StreamCommand

# PlatformIO builds one at a time.
_BUILDING = threading.Lock()


@dataclass(frozen=True)
class ModelOffer:
    """A model that a page can choose.

    Attributes:
        name: of its folder.
        model_id: of its weights; None for firmware that does not tell it.
        offer: its labels, and the drawings to lay out.
        find_image: returns its firmware if there is one.
        build: makes it; raises TilencaError where it cannot.
    """

    name: str
    model_id: int | None
    offer: Offer
    find_image: Callable[[], Path | None]
    build: Callable[[], Path]

    @property
    def id_text(self) -> str:
        """The id as tiles say it."""
        return "" if self.model_id is None else f"{self.model_id:04X}"

    def image(self) -> Path:
        """Its firmware, built if need be; several may ask at the same time."""
        with _BUILDING:
            return self.find_image() or self.build()


class ChosenSource:
    """Tiles of one of some models; see `tilenca.page.session.Source`."""

    def __init__(self, models: Sequence[ModelOffer], wanted: str = "") -> None:
        """Makes nothing yet.

        Args:
            models: to choose from, the usual one first.
            wanted: the name or the id of one; the usual one where it is none of them.
        """
        self._models = models
        self._model = next((one for one in models if wanted and wanted in (one.name, one.id_text)), models[0])
        self._source: EmulatedSource | None = None
        self._failed = False

    def begin(self) -> list[StreamEvent]:
        """What is here; of firmware that is to be built first, that it is."""
        if image := self._model.find_image():
            return self._made(image)
        return [{**stream_event("building", looks=[], drawings=[], takes=["seen"]), **self._choice()}]

    def _made(self, image: Path) -> list[StreamEvent]:
        offer = self._model.offer
        self._source = EmulatedSource(image, firmware_settings(image), offer.labels, offer.drawings)
        first, *rest = self._source.begin()
        return [{**first, **self._choice()}, *rest]

    def _choice(self) -> StreamEvent:
        """What of the stream's first event the models are."""
        models = [
            {"name": one.name, "id": one.id_text, "labels": list(one.offer.labels)} for one in self._models
        ]
        return {"models": models, "model": self._model.name}

    def take(self, command: StreamCommand) -> None:
        """Passes it on."""
        if self._source is None:
            raise UsageError(f"the firmware of {self._model.name} is not built yet")
        self._source.take(command)

    def advance(self, wall_s: float) -> list[StreamEvent]:
        """Passes it on, or builds the firmware, which takes a minute."""
        if self._source is not None:
            return self._source.advance(wall_s)
        if self._failed:
            return []
        try:
            return self._made(self._model.image())
        except TilencaError:
            self._failed = True
            raise

    @property
    def is_idle(self) -> bool:
        """Whether nothing happens until the next command."""
        return self._failed if self._source is None else self._source.is_idle

    def close(self) -> None:
        """Frees the tiles."""
        if self._source is not None:
            self._source.close()
