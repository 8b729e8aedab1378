"""The firmware of a model, built beside the model's files: the project's own firmware stays as it is."""

import shutil
from collections.abc import Iterator
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.base.project import firmware_image, project
from tilenca.fleet.build import build
from tilenca.model.file import Model
from tilenca.model.render import check_fits, render, write_files

PARTS = ("include", "src")
RENDERED = "model"  # the folder of both parts that `render` fills


def build_beside(model: Model, folder: Path, force: bool = False, quiet: bool = False) -> Path:
    """Builds a model's firmware in its folder; returns the image. What is up to date is not built again.

    Args:
        model: to build in.
        folder: of the model.
        force: overwrite rendered files that were edited by hand.
        quiet: do not say that it builds.

    Raises:
        BuildError: the model does not fit, there is no project, or the build failed.
    """
    check_fits(model)
    sources, out = project() / "firmware", paths.model_firmware(folder)
    try:
        _copy_sources(sources, out)
    except OSError as error:
        raise BuildError(f"{error.filename or out}: {error.strerror}; make {folder} writable") from error
    write_files(out, render(model), force)
    build(out, quiet)
    return paths.model_elf(folder)


def image_of(folder: Path) -> Path:
    """The image that was built beside a model.

    Raises:
        BuildError: none was built yet; the message says how.
    """
    image = paths.model_elf(folder)
    if image.exists():
        return image
    if folder.resolve() == paths.DEFAULT_MODEL.resolve():  # the project's own firmware has it
        return firmware_image()
    raise BuildError(f"{folder}: no firmware was built of it; run: tilenca export --model {folder} --build")


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
