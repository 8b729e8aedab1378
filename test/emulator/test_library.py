"""The C++ part alone: a C program that knows nothing of Python or neural networks."""

import re
from pathlib import Path

from support.avr import ROOT, Compile, run_tool

SOURCES = ROOT / "tools" / "emulator" / "src"

PROGRAM = r"""
#include "capi.h"
#include <stdio.h>

int main(int argc, char** argv) {
    const double ppm[2] = {100, -100}, on[2] = {0, 0.001};
    tilenca_array* array = argc == 2 ? tilenca_array_new(argv[1], NULL, 2, ppm, on) : NULL;
    if (array == NULL) {
        printf("%s\n", tilenca_last_error());
        return 1;
    }
    tilenca_array_link(array, 0, 1, 1, 3);
    tilenca_array_run(array, 0.01);
    uint8_t bytes[100];
    double times[100];
    size_t count = tilenca_tile_receive(array, 1, bytes, times, sizeof bytes);
    printf("%.*s at %.3f s", (int)count, (char*)bytes, tilenca_array_time(array));
    tilenca_array_free(array);
    return 0;
}
"""


def test_a_c_program_runs_tiles(library: Path, avr: Compile, tmp_path: Path) -> None:
    source, program = tmp_path / "alone.c", tmp_path / "alone"
    source.write_text(PROGRAM)
    search = ("-I", SOURCES, library, f"-Wl,-rpath,{library.parent}")
    run_tool("gcc", "-std=c99", "-Wall", "-Werror", "-pedantic", source, "-o", program, *search)
    elf = avr("""
    int main(void) {
        UBRR0 = 16; UCSR0A = 2; UCSR0B = 8;
        for (const char *c = "alone"; *c; c++) { while (!(UCSR0A & 0x20)) { } UDR0 = *c; }
        for (;;) { }
    }""")
    assert run_tool(program, elf) == "alone at 0.010 s"


def test_nothing_in_it_knows_of_networks_or_telemetry() -> None:
    for source in SOURCES.rglob("*"):
        if source.suffix in (".h", ".cpp"):
            text = source.read_text().lower()
            assert not re.search(r"neural|cellular|\bnca\b|telemetry|\$tile|cobs", text), source


def test_every_function_of_the_header_is_declared_in_python_with_as_many_arguments() -> None:
    from tilenca.emulator.library import _SIGNATURES

    header = (SOURCES / "capi.h").read_text()
    declared = {
        name: 0 if arguments == "void" else arguments.count(",") + 1
        for name, arguments in re.findall(r"\btilenca_(\w+)\(([^)]*)\);", header)
    }
    assert declared == {name: len(arguments) for name, (_, arguments) in _SIGNATURES.items()}
