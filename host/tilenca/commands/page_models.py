"""The models that `tilenca page` offers: the one of the firmware or of `--model`, and those that ship."""

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import BuildError, TilencaError
from tilenca.base.project import build_remedy, firmware_image
from tilenca.base.shipped import model_names
from tilenca.commands.arguments import existing_image
from tilenca.commands.origin import model_with_id, own_shapes
from tilenca.commands.own_firmware import build_beside, can_build, image_of
from tilenca.emulator.greeting import greeting
from tilenca.model.file import Model, load_model
from tilenca.page.chosen import ModelOffer
from tilenca.page.offer import Offer, load_offer
from tilenca.protocol.stream_fields import MOST_TILES


def page_models(elf: Path | None, model: Path | None, shapes: Sequence[Path]) -> list[ModelOffer]:
    """The models to choose from, the usual one first.

    Args:
        elf: the image of `--elf`: it alone is offered.
        model: the folder of `--model`.
        shapes: the files of `--shapes`; whoever names some wants no other model.

    Raises:
        TilencaError: an image, a model or a shape file cannot be used.
    """
    first = _of_folder(model, shapes) if model else _of_image(elf or firmware_image(), shapes)
    if elf or shapes:
        return [first]
    models = [first]
    for name in model_names():
        with suppress(TilencaError):  # its drawings do not ship, or there is nothing to build it in
            offer = _of_folder(paths.MODELS / name, ())
            if all(offer.model_id != one.model_id for one in models) and _can_be_had(offer):
                models.append(offer)
    return models


def _can_be_had(offer: ModelOffer) -> bool:
    return can_build(paths.MODELS / offer.name) or offer.find_image() is not None


def _of_image(image: Path, shapes: Sequence[Path]) -> ModelOffer:
    """The model of an image, by what it says of itself."""
    existing_image(image, f"{build_remedy()}, or give --elf")
    hello = greeting(image)
    known = model_with_id(hello.model_id) if hello else None
    offer = _drawings(*known, shapes) if known else load_offer(shapes)
    name = known[1].name if known else image.name

    def again(cancelled: threading.Event) -> Path:
        raise BuildError(f"{image}: no such file any more; {build_remedy()}")

    return ModelOffer(name, hello.model_id if hello else None, offer, _finder(image), again)


def _of_folder(folder: Path, shapes: Sequence[Path]) -> ModelOffer:
    """A model by its folder; its firmware is built when a page asks for it."""
    model = load_model(folder)
    offer = _drawings(model, folder, shapes)

    def find() -> Path | None:
        with suppress(TilencaError):
            if (image := image_of(folder)).is_file() and _runs(image, model):
                return image
        return None

    def build(cancelled: threading.Event) -> Path:
        if not can_build(folder):
            raise BuildError(f"{image_of(folder)}: has another model than {folder}; {build_remedy()}")
        return build_beside(model, folder, cancelled=cancelled)

    return ModelOffer(folder.resolve().name, model.model_id, offer, find, build)


def _runs(image: Path, model: Model) -> bool:
    """Whether an image has a model: one beside it may be of weights that were trained anew since."""
    hello = greeting(image)
    return hello is not None and hello.model_id == model.model_id


def _finder(image: Path) -> Callable[[], Path | None]:
    return lambda: image if image.is_file() else None


def _drawings(model: Model, folder: Path, shapes: Sequence[Path]) -> Offer:
    """The model's labels and drawings, as many as fit on the board; of the digits those of all sizes."""
    own = list(shapes) or own_shapes(model, folder)
    is_usual = [path.resolve() for path in own] == [paths.DEFAULT_SHAPES.resolve()]
    offer = load_offer(() if is_usual else own)
    fitting = tuple(one for one in offer.drawings if len(one.shape.cells) <= MOST_TILES)
    labels = tuple(model.labels) if not shapes else offer.labels
    return Offer(labels, fitting or offer.drawings)
