"""`tilenca new`: a folder with shapes, firmware and builds of one's own."""

import argparse
import configparser
import json
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.model.file import load_model
from tilenca.model.render import render, write_files

TEMPLATE = paths.PACKAGE / "commands" / "new_project"
GITIGNORE = "gitignore"  # without its dot in the package, where it must ignore nothing
FIRMWARE_PARTS = ("include", "src")
LOCAL_INI = "platformio.local.ini"
PACKAGE_FOLDERS = ("core_dir", "platforms_dir", "packages_dir")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the command's options."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="the project's folder: new, or empty")
    parser.add_argument("--json", action="store_true", help="one JSON document on stdout")


def run(args: argparse.Namespace) -> int:
    """Lays the project out and says what is in it."""
    folder: Path = args.folder
    made = _make_folder(folder)
    try:
        files = sorted(_lay_out(folder))
    except BaseException:
        _empty(folder)
        if made:
            folder.rmdir()
        raise
    if args.json:
        print(json.dumps({"project": str(folder.resolve()), "files": files}))
    else:
        print(f"{folder}: {len(files)} files; its README.md says what to do. Next: cd {folder}")
    return 0


def _make_folder(folder: Path) -> bool:
    """Makes the folder if it is not there; whether it did.

    Raises:
        UsageError: it cannot be made, or holds something.
    """
    try:
        folder.mkdir(parents=True)
    except FileExistsError as error:
        if not folder.is_dir():
            raise UsageError(f"{folder}: not a folder; give a new one") from error
        if any(folder.iterdir()):
            raise UsageError(f"{folder}: not empty; give a new or an empty folder") from error
        return False
    except OSError as error:
        raise UsageError(f"{folder}: {error.strerror}; give a folder that can be made") from error
    return True


def _empty(folder: Path) -> None:
    for entry in folder.iterdir():
        shutil.rmtree(entry) if entry.is_dir() else entry.unlink()


def _lay_out(folder: Path) -> Iterator[str]:
    """Writes the files; yields their paths below the folder."""
    for source, target in _sources():
        path = folder / target
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, path)  # its content only: the package's files may be read-only
        yield str(target)
    # In a checkout, firmware/ may hold another model just now.
    write_files(folder / "firmware", render(load_model(paths.DEFAULT_MODEL)), force=True)
    if (local := _local_packages()) is not None:
        (folder / LOCAL_INI).write_text(local, encoding="utf-8")
        yield LOCAL_INI


def _sources() -> Iterator[tuple[Path, Path]]:
    """Each file that is copied, and where it goes."""
    for source in _files(TEMPLATE):
        target = source.relative_to(TEMPLATE)
        yield source, Path(f".{GITIGNORE}") if target == Path(GITIGNORE) else target
    for part in FIRMWARE_PARTS:
        for source in _files(paths.FIRMWARE / part):
            yield source, "firmware" / source.relative_to(paths.FIRMWARE)


def _files(folder: Path) -> Iterator[Path]:
    return (path for path in sorted(folder.rglob("*")) if path.is_file() and not path.name.startswith("."))


def _local_packages() -> str | None:
    """PlatformIO's packages where the checkout has its own, since the registry could not be reached."""
    if paths.CHECKOUT is None:
        return None
    config = configparser.ConfigParser(interpolation=None)
    with suppress(configparser.Error, UnicodeDecodeError):
        config.read(paths.CHECKOUT / LOCAL_INI, encoding="utf-8")
    given = {name: config.get("platformio", name, fallback=None) for name in PACKAGE_FOLDERS}
    found = {name: paths.CHECKOUT / folder for name, folder in given.items() if folder}
    if not found:
        return None
    lines = "\n".join(f"{name} = {path}" for name, path in found.items())
    return (
        f"; PlatformIO's packages are those of the checkout that made this project.\n[platformio]\n{lines}\n"
    )
