"""Translated images: blocks of an image's instructions as compiled C++, with the same results in less time.

Never needed. An array uses the translation of its image once there is one, and starts making it in the
background when it has run for a while. Without a compiler the interpreter executes everything.
"""

import hashlib
import os
import shutil
import stat
import subprocess
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.emulator.library import LIBRARY, call

# "0" turns all of this off; a path is the folder to keep translations in.
SETTING = "TILENCA_TRANSLATIONS"
# After so many emulated seconds of all tiles together a translation pays.
WORTHWHILE_TILE_S = 40.0
# For a compiler that takes g++'s options.
FLAGS = (
    *("-std=c++17", "-O2", "-w", "-fPIC", "-shared", "-fvisibility=hidden", "-fno-semantic-interposition"),
    "-fno-tree-slp-vectorize",
    *("-foptimize-sibling-calls", "-fomit-frame-pointer", "-fno-exceptions"),
    "-fno-asynchronous-unwind-tables",
)
COMPILERS = ("g++", "c++", "clang++")
MAKER = "tilenca.emulator.translator"  # the module that makes translations


def folder() -> Path | None:
    """Where translations are kept; None: the user wants none."""
    setting = os.environ.get(SETTING)
    if setting:
        return None if setting == "0" else Path(setting).absolute()
    if paths.CHECKOUT is not None:
        return paths.BUILD / "translations"
    try:
        cache_folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:  # nobody's home
        return None
    return cache_folder / "tilenca" / "translations"


def _trusted(path: Path) -> bool:
    """Whether only this user, or root, can have put the file there: it is code that this process will run."""
    with suppress(OSError):
        return all(
            status.st_uid in (os.geteuid(), 0) and not status.st_mode & stat.S_IWOTH
            for status in (path.stat(), path.parent.stat())
        )
    return False


@cache
def _library_digest(library: Path) -> bytes:
    return hashlib.sha256(library.read_bytes()).digest()


def path_of(image: Path) -> Path | None:
    """The file of an image's translation for this library, there or not; None: there is none to be."""
    place = folder()
    if place is None:
        return None
    try:
        content = image.read_bytes()
    except OSError:
        return None
    digest = hashlib.sha256(_library_digest(LIBRARY) + " ".join(FLAGS).encode() + content)
    return place / f"{digest.hexdigest()[:32]}.so"


def compiler() -> str | None:
    """A C++ compiler, or None."""
    return next(filter(None, map(shutil.which, COMPILERS)), None)


_begun: set[Path] = set()  # by this process


def begin(image: Path) -> None:
    """Starts making the translation of an image in the background, unless somebody does already."""
    path = path_of(image)
    if path is None or path in _begun or path.exists() or compiler() is None:
        return
    _begun.add(path)
    with suppress(OSError):
        subprocess.Popen(
            [sys.executable, "-P", "-m", MAKER, "--background", str(image.absolute())],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )


class Translator:
    """Lets one array use the translation of its image, as soon as there is one."""

    def __init__(self, image: Path, wanted: bool) -> None:
        """Looks for nothing yet.

        Args:
            image: that the array runs.
            wanted: whether to use a translation at all.
        """
        self._image = image
        self._path = path_of(image) if wanted else None
        self.in_use = False
        self._run_tile_s = 0.0
        self._next_look_tile_s = WORTHWHILE_TILE_S

    def use(self, handle: object) -> bool:
        """Whether the array executes translated blocks from now on."""
        if self._path is None or not _trusted(self._path):
            return False
        path, self._path = self._path, None
        try:
            call("array_use_translation", handle, os.fsencode(path))
        except UsageError:  # damaged, or another program stands in its place
            return False
        self.in_use = True
        return True

    def note(self, handle: object, tile_s: float) -> None:
        """The array has run for so long, all tiles together."""
        self._run_tile_s += tile_s
        if self._path is None or self._run_tile_s < self._next_look_tile_s:
            return
        if not self.use(handle) and self._path is not None:
            if self._next_look_tile_s == WORTHWHILE_TILE_S:
                begin(self._image)
            self._next_look_tile_s = self._run_tile_s + WORTHWHILE_TILE_S
