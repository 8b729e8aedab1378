"""Folders that look like projects of `tilenca new`."""

from pathlib import Path

from tilenca.base import paths

MARKED = "[platformio]\n[tilenca]\nflags = -O2\n"


def make_project(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "platformio.ini").write_text(MARKED, encoding="utf-8")
    return folder


def make_build(folder: Path) -> Path:
    elf = paths.built_elf(folder)
    elf.parent.mkdir(parents=True)
    elf.touch()
    return elf
