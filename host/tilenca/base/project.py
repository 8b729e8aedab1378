"""Messages for a missing project, build or extra."""

from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import BuildError
from tilenca.base.stdio import warn


def project() -> Path:
    """The folder in which firmware is rendered and built.

    Raises:
        BuildError: tilenca is installed from a wheel, and the working directory is in no project.
    """
    if paths.PROJECT is None:
        raise BuildError("no project here to build firmware in; make one: tilenca new DIR, then cd DIR")
    return paths.PROJECT


def firmware_image() -> Path:
    """The image that commands run and write; says so where it is not the project's own."""
    image = paths.firmware_elf()
    if paths.PROJECT not in (None, paths.CHECKOUT) and image == paths.FIRMWARE_ELF:
        warn(
            f"{paths.PROJECT} has no build yet: using the digits that come with tilenca; build with: pio run"
        )
    return image


def build_remedy() -> str:
    """How to get the missing image of `firmware_image`."""
    return "run `pio run`" if paths.CHECKOUT is None else "run `make demo` or `pio run`"


def place_of(path: Path) -> str:
    """A path as seen from the project, or from what comes with tilenca, if it is inside."""
    full = path.resolve()
    for root in (paths.PROJECT, paths.ROOT):
        if root is not None and full.is_relative_to(root.resolve()):
            return str(full.relative_to(root.resolve()))
    return str(path)


def install_remedy(extra: str = "") -> str:
    """The command that installs what an extra of the package brings; without one, the package's own needs.

    Args:
        extra: of pyproject.toml.
    """
    if paths.CHECKOUT is None:
        return f"pip install 'tilenca[{extra}]'" if extra else "pip install --force-reinstall tilenca-*.whl"
    level = "setup-train" if extra in ("train", "plot", "sweep") else "setup"
    return f"make {level}"
