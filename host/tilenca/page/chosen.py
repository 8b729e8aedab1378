"""The emulated tiles of the model that a page has chosen; its firmware is built first where there is none."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tilenca.base.errors import BuildError, TilencaError, UsageError
from tilenca.emulator.greeting import firmware_settings
from tilenca.fleet.build import CANCELLED, LOOK_S
from tilenca.page.emulated import EmulatedSource
from tilenca.page.offer import Offer
from tilenca.protocol.stream import MOST_REFUSAL, StreamEvent, stream_event
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
        build: makes it, unless the event is set meanwhile; raises TilencaError where it cannot.
    """

    name: str
    model_id: int | None
    offer: Offer
    find_image: Callable[[], Path | None]
    build: Callable[[threading.Event], Path]

    @property
    def id_text(self) -> str:
        """The id as tiles say it."""
        return "" if self.model_id is None else f"{self.model_id:04X}"

    def image(self, cancelled: threading.Event) -> Path:
        """Its firmware, built if need be; several may ask at the same time.

        Raises:
            TilencaError: it cannot be built, or was cancelled.
        """
        while not _BUILDING.acquire(timeout=LOOK_S):
            if cancelled.is_set():
                raise BuildError(CANCELLED)
        try:
            return self.find_image() or self.build(cancelled)
        finally:
            _BUILDING.release()


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
        self._abandoned = threading.Event()

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
        """Passes it on, or builds the firmware, which takes a minute; tells where that fails."""
        if self._source is not None:
            return self._source.advance(wall_s)
        if self._failed or self._abandoned.is_set():
            return []
        try:
            return self._made(self._model.image(self._abandoned))
        except TilencaError as error:
            self._failed = True
            about = {"looks": [], "drawings": [], "takes": ["seen"], "reason": str(error)[:MOST_REFUSAL]}
            return [{**stream_event("failed", **about), **self._choice()}]

    @property
    def is_idle(self) -> bool:
        """Whether nothing happens until the next command."""
        return self._failed if self._source is None else self._source.is_idle

    def abandon(self) -> None:
        """Ends a build that is under way."""
        self._abandoned.set()

    def close(self) -> None:
        """Frees the tiles."""
        if self._source is not None:
            self._source.close()
