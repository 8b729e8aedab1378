"""The C++ part alone: a C program that knows nothing of Python or neural networks."""

import re
from pathlib import Path

import pytest

from support.avr import ROOT, Compile, run_tool
from tilenca.emulator.library import library as library_in_python

EMULATOR = ROOT / "tools" / "emulator"
INCLUDES = (EMULATOR / "include", ROOT / "tools" / "c_api" / "include")

PROGRAM = r"""
#include "tilenca/emulator.h"
#include <stdio.h>

int main(int argc, char** argv) {
    const double ppm[2] = {100, -100}, on[2] = {0, 0.001};
    tilenca_array* array = argc == 2 ? tilenca_array_new(argv[1], NULL, 2, ppm, on) : NULL;
    if (array == NULL) {
        printf("%s\n", tilenca_emulator_last_error());
        return 1;
    }
    if (tilenca_array_link(array, 0, 1, 1, 3) != 0 || tilenca_array_run(array, 0.01) != 0) {
        return 2;
    }
    uint8_t bytes[100];
    double times[100];
    ptrdiff_t count = tilenca_tile_receive(array, 1, bytes, times, sizeof bytes);
    printf("%.*s at %.3f s", (int)count, (char*)bytes, tilenca_array_time(array));
    tilenca_array_free(array);
    return 0;
}
"""


def test_a_c_program_runs_tiles(library: Path, avr: Compile, tmp_path: Path) -> None:
    source, program = tmp_path / "alone.c", tmp_path / "alone"
    source.write_text(PROGRAM)
    folders = [word for folder in INCLUDES for word in ("-I", folder)]
    search = (*folders, library, f"-Wl,-rpath,{library.parent}")
    run_tool("gcc", "-std=c99", "-Wall", "-Werror", "-pedantic", source, "-o", program, *search)
    elf = avr("""
    int main(void) {
        UBRR0 = 16; UCSR0A = 2; UCSR0B = 8;
        for (const char *c = "alone"; *c; c++) { while (!(UCSR0A & 0x20)) { } UDR0 = *c; }
        for (;;) { }
    }""")
    assert run_tool(program, elf) == "alone at 0.010 s"


def test_nothing_in_it_knows_of_networks_or_telemetry() -> None:
    for source in EMULATOR.rglob("*"):
        if source.suffix in (".h", ".cpp"):
            text = source.read_text().lower()
            assert not re.search(r"neural|cellular|\bnca\b|telemetry|\$tile|cobs", text), source


def test_python_reads_every_function_of_the_header() -> None:
    """With its arguments: cffi refuses a call with others."""
    header = (EMULATOR / "include" / "tilenca" / "emulator.h").read_text(encoding="utf-8")
    declared = set(re.findall(r"^TILENCA_API .*?\b(tilenca_\w+)\(", header, re.MULTILINE))
    emulator = library_in_python()
    assert declared == {name for name in dir(emulator.lib) if name.startswith("tilenca_")}
    for name in declared - {"tilenca_emulator_abi_version", "tilenca_emulator_last_error"}:
        with pytest.raises(TypeError, match="arguments"):
            getattr(emulator.lib, name)()
