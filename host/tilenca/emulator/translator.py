"""Makes the translation of an image: runs it to see what is executed most, and compiles that.

python -m tilenca.emulator.translator firmware.elf
"""

import argparse
import fcntl
import os
import re
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from tilenca.base.errors import BuildError, TilencaError
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator.array import Array
from tilenca.emulator.library import call, text
from tilenca.emulator.translation import FLAGS, SETTING, compiler, path_of

# What is counted: a block of tiles of this size, for so long.
ROWS = COLUMNS = 3
COUNTED_S = 0.6
MOST_KEPT = 20
NAME = re.compile(r"[0-9a-f]{32}")  # of a translation, see path_of


def source_of(image: Path) -> str:
    """The C++ text of an image's blocks that are executed most, found by running it.

    Raises:
        BuildError, UsageError: the image cannot be used, or the emulator is not built.
    """
    places = range(ROWS * COLUMNS)
    across = [(i, EAST, i + 1, WEST) for i in places if i % COLUMNS != COLUMNS - 1]
    down = [(i, SOUTH, i + COLUMNS, NORTH) for i in places[:-COLUMNS]]
    ppm = [700.0 * (i - ROWS * COLUMNS // 2) for i in places]
    with Array(image, len(places), across + down, ppm, translated=False) as array:
        call("array_count_instructions", array.handle)
        with suppress(TilencaError):  # it stops at a fault: what ran until then was counted
            array.run(COUNTED_S)
        return text(call("array_translated", array.handle))


def make(image: Path) -> Path:
    """Makes the translation of an image, or finds it made; returns its file.

    Raises:
        BuildError: there is no compiler, or it failed; translations are turned off.
        BuildError, UsageError: the image cannot be used.
    """
    path, command = path_of(image), compiler()
    if path is None or command is None:
        raise BuildError(f"{image}: not translated; install g++, and unset {SETTING}")
    if path.exists():
        return path
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as made:
        source, library = Path(made) / "blocks.cpp", Path(made) / "blocks.so"
        source.write_text(source_of(image), encoding="ascii")
        done = subprocess.run(
            [command, *FLAGS, "-o", str(library), str(source)], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            raise BuildError(f"{image}: its translation does not compile: {done.stderr.strip()[:200]}")
        library.replace(path)
    _forget_old(path.parent)
    return path


def _forget_old(place: Path) -> None:
    """Removes all but the newest translations; those of other builds are never used again."""
    with suppress(OSError):
        ours = [path for path in place.glob("*.so") if NAME.fullmatch(path.stem)]
        newest_first = sorted(ours, key=lambda path: path.stat().st_mtime, reverse=True)
        for path in newest_first[MOST_KEPT:]:
            path.unlink(missing_ok=True)


def _make_alone(image: Path) -> None:
    """Makes a translation with the least claim to the processor, if nobody else is about to."""
    path = path_of(image)
    if path is None or path.exists():
        return
    failed = path.with_suffix(".failed")
    if failed.exists():  # what did not compile once will not do so again
        return
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with path.with_suffix(".lock").open("a") as lock:
        with suppress(OSError):
            os.nice(19)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return
        try:
            make(image)
        except BuildError:
            failed.touch()
            raise
    path.with_suffix(".lock").unlink(missing_ok=True)


def main() -> int:
    """Makes a translation; in the background nobody hears of a failure."""
    parser = argparse.ArgumentParser(description="Translate an image for the emulator.")
    parser.add_argument("image", type=Path)
    parser.add_argument("--background", action="store_true", help="unless another process does")
    args = parser.parse_args()
    try:
        if args.background:
            _make_alone(args.image)
        else:
            print(make(args.image))
    except (TilencaError, OSError) as error:
        print(f"translation: {error}", file=sys.stderr)
        return error.exit_status if isinstance(error, TilencaError) else 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
