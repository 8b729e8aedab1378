"""The firmware of a model, built beside the model's files: the project's own firmware stays as it is."""

import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.base.project import build_remedy, firmware_image, project
from tilenca.base.shipped import model_names
from tilenca.base.suggest import did_you_mean
from tilenca.commands.arguments import existing_image
from tilenca.emulator.greeting import greeting
from tilenca.fleet.build import build
from tilenca.model.file import Model, checkpoints, load_model
from tilenca.model.render import check_fits, render, write_files
from tilenca.training.sessions import sessions_of

PARTS = ("include", "src")
RENDERED = "model"  # the folder of both parts that `render` fills


def build_beside(
    model: Model,
    folder: Path,
    force: bool = False,
    quiet: bool = False,
    cancelled: threading.Event | None = None,
) -> Path:
    """Builds a model's firmware in its folder; returns the image. What is up to date is not built again.

    Args:
        model: to build in.
        folder: of the model.
        force: overwrite rendered files that were edited by hand.
        quiet: do not say that it builds.
        cancelled: ends the build as soon as it is set.

    Raises:
        BuildError: the model does not fit, there is no project, or the build failed or was cancelled.
    """
    check_fits(model)
    sources, out = project() / "firmware", paths.model_firmware(folder)
    try:
        _copy_sources(sources, out)
    except OSError as error:
        raise BuildError(f"{error.filename or out}: {error.strerror}; make {folder} writable") from error
    write_files(out, render(model), force)
    build(out, quiet, cancelled)
    return paths.model_elf(folder)


def image_of(folder: Path) -> Path:
    """The image that was built beside a model.

    Raises:
        BuildError: none was built yet, or of the digits the project's own firmware has another model; the
            message says how to build one.
    """
    image = paths.model_elf(folder)
    if image.exists():
        return image
    if not (folder / "model.json").exists():
        raise BuildError(f"{folder}: {_begun(folder) or _no_model(folder)}")
    remedy = f"run: tilenca export --model {folder} --build"
    if folder.resolve() != paths.DEFAULT_MODEL.resolve():
        raise BuildError(f"{folder}: no firmware was built of it; {remedy}")
    image = firmware_image()
    existing_image(image, build_remedy())
    hello, model_id = greeting(image), load_model(folder).model_id
    if hello is None or hello.model_id != model_id:
        other = "no model" if hello is None else f"model {hello.model_id:04X}"
        raise BuildError(f"{image}: has {other}, not {model_id:04X} of {folder}; {remedy}")
    return image


def _begun(folder: Path) -> str | None:
    """What to say of a folder whose model is not there yet; None: nothing was trained there."""
    sessions = sessions_of(folder)
    if any(session.is_running for session in sessions):
        return "its model is still being trained or measured; wait for the end of that, or see: tilenca runs"
    if not checkpoints(folder):
        return None
    command = f"{sessions[-1].command} --resume" if sessions else "the command that began it, with --resume"
    return f"its training was interrupted, and there is no model yet; go on with: {command}"


def _no_model(folder: Path) -> str:
    """What to say of a folder in which no training ever was."""
    beside = sorted(str(about.parent) for about in folder.parent.glob("*/model.json"))
    here = sorted(about.parent.name for about in Path("models").glob("*/model.json"))
    meant = did_you_mean(str(folder), [*beside, *here, *model_names()])
    return f"no model is there{meant}; make one: tilenca make FILE"


def image_to_write(folder: Path, building: bool = True) -> Path:
    """The image of a model for real tiles, brought up to date beside the model's files where it can be.

    Args:
        folder: of the model.
        building: whether to build; else what was built is taken as it is.

    Raises:
        BuildError: as `build_beside` and `image_of`.
    """
    if not building or not can_build(folder):
        return image_of(folder)
    return build_beside(load_model(folder), folder)


def can_build(folder: Path) -> bool:
    """Whether a model's firmware can be built beside it: an installed package is not written to."""
    installed = paths.CHECKOUT is None and folder.resolve().is_relative_to(paths.MODELS.resolve())
    return paths.PROJECT is not None and not installed


def _copy_sources(sources: Path, out: Path) -> None:
    """Brings the copy up to date; files that are as they should be stay, so that little is compiled anew."""
    wanted = {path.relative_to(sources): path for path in _sources(sources)}
    for stale in [path for path in _sources(out) if path.relative_to(out) not in wanted]:
        stale.unlink()
    for place, source in wanted.items():
        target = out / place
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)


def _sources(folder: Path) -> Iterator[Path]:
    """All sources but the rendered ones."""
    for part in PARTS:
        for path in sorted((folder / part).rglob("*")):
            if path.is_file() and path.relative_to(folder / part).parts[0] != RENDERED:
                yield path
