"""The paths of the project's files. Only this module knows a checkout from an installed wheel.

In a checkout everything is in the tree. A wheel carries the same files in its folder `data`, and the built
firmware of the shipped digits. A project that `tilenca new` made, found from the working directory upwards,
has its own firmware and its own builds.
"""

import re
from contextlib import suppress
from importlib import resources
from pathlib import Path

FIRMWARE_ENV = "megaatmega2560"
PLATFORMIO_INI = "platformio.ini"
# The section of platformio.ini that marks a project of `tilenca new`; its build needs it, so that it stays.
PROJECT_MARK = re.compile(r"^\[tilenca\]", re.MULTILINE)

PACKAGE = Path(str(resources.files("tilenca")))
DATA = PACKAGE / "data"  # only a wheel has it
CHECKOUT = None if DATA.is_dir() else PACKAGE.parents[1]

# What comes with tilenca; a wheel's data is laid out as the tree.
ROOT = CHECKOUT or DATA
SHAPES = ROOT / "shapes"
MODELS = ROOT / "models"
DEFAULT_SHAPES = SHAPES / "digits.toml"
DEFAULT_MODEL = MODELS / "digits"
FIRMWARE = ROOT / "firmware"
BUILD = ROOT / "build"
PAGE = ROOT / "page"


def built_elf(project: Path) -> Path:
    """The image that `pio run` builds in a project."""
    return project / ".pio" / "build" / FIRMWARE_ENV / "firmware.elf"


# The image that comes with tilenca: the last build of a checkout, the shipped digits in a wheel.
FIRMWARE_ELF = built_elf(CHECKOUT) if CHECKOUT else ROOT / "image" / "firmware.elf"


def model_firmware(model: Path) -> Path:
    """The folder beside a model's files in which its firmware is built; PlatformIO's build is in it."""
    return model / "firmware"


def model_elf(model: Path) -> Path:
    """The image that was built beside a model's files."""
    return model_firmware(model) / "build" / FIRMWARE_ENV / "firmware.elf"


def find_project(start: Path) -> Path | None:
    """The nearest folder at or above `start` that `tilenca new` made."""
    for folder in (start, *start.parents):
        with suppress(OSError, UnicodeDecodeError):
            if PROJECT_MARK.search((folder / PLATFORMIO_INI).read_text(encoding="utf-8")):
                return folder
    return None


def _working_directory() -> Path:
    try:
        return Path.cwd()
    except OSError:  # it was removed
        return ROOT


# Where firmware is rendered and built: the project around the working directory, else the checkout.
PROJECT = find_project(_working_directory()) or CHECKOUT


def firmware_elf() -> Path:
    """The image that commands use: the project's last build, else the one that comes with tilenca."""
    if PROJECT is not None and (built := built_elf(PROJECT)).exists():
        return built
    return FIRMWARE_ELF
