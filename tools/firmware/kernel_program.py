"""Programs for the emulated chip around the firmware's kernel and a network of any widths."""

import subprocess
from pathlib import Path

from tilenca.base import paths
from tilenca.model import render
from tilenca.model.file import Model

SOURCES = ("src/core/network.cpp", "src/avr/layers.cpp", "src/avr/kernel.S", "src/avr/sum.S")
WEIGHTS = "src/model/model.cpp"


def program(model: Model, source: Path, folder: Path, *options: str) -> Path:
    """`source`, compiled for the chip as the firmware is, with the model and the kernel; its ELF file.

    Raises:
        CalledProcessError: it does not compile.
    """
    for path, text in render.render(model).items():
        folder.joinpath(path).parent.mkdir(parents=True, exist_ok=True)
        folder.joinpath(path).write_text(text, encoding="utf-8")
    elf = folder / f"{source.stem}.elf"
    command = ["avr-g++", "-mmcu=atmega2560", "-DF_CPU=16000000UL", "-std=gnu++14", "-O2", "-flto", "-Wall"]
    command += ["-Wextra", "-Werror", f"-I{folder / 'include'}", f"-I{paths.FIRMWARE / 'include'}", *options]
    sources = [source, *(paths.FIRMWARE / path for path in SOURCES), folder / WEIGHTS]
    subprocess.run([*command, "-o", str(elf), *map(str, sources)], check=True)
    return elf
