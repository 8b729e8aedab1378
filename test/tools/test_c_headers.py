"""The libraries from plain C: their headers compile as C99 and C++, alone, and small programs work."""

from pathlib import Path

import pytest

from support.avr import ROOT, hex_record, run_tool
from tilenca.base.native_library import FOLDERS, find

SHARED = ROOT / "tools" / "c_api" / "include"
STRICT = ("-Wall", "-Wextra", "-Werror", "-pedantic")

PROGRAMS = {
    "emulator": r"""
int main(int argc, char** argv) {
    const double ppm[2] = {100, -100}, on[2] = {0, 0.001};
    tilenca_array* array = tilenca_array_new(argv[argc - 1], NULL, 2, ppm, on);
    tilenca_cycles cycles;
    if (array == NULL || tilenca_array_link(array, 0, 1, 1, 3) != 0 || tilenca_array_run(array, 0.01) != 0) {
        printf("%s\n", tilenca_emulator_last_error());
        return 1;
    }
    if (tilenca_tile_cycles(array, 1, &cycles) != 0 || tilenca_tile_pc(array, 2) >= 0) {
        return 2;
    }
    printf("%d %.0f cycles; %s", TILENCA_EMULATOR_ABI_VERSION == tilenca_emulator_abi_version(),
           (double)cycles.total, tilenca_emulator_last_error());
    tilenca_array_free(array);
    return 0;
}
""",
    "simulator": r"""
int main(void) {
    /* One weight: a cell's first channel goes through both hidden layers and back into itself. */
    const int8_t w1[5] = {64, 0, 0, 0, 0}, w2[1] = {64}, w3[1] = {1};
    const int16_t bias[1] = {0};
    const tilenca_model model = {1, 1, 1, 1, w1, bias, w2, bias, w3, bias};
    int16_t states[2] = {8192, 0};
    const int8_t inputs[10] = {64, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    if (tilenca_update_cells(&model, states, inputs, 2, 1) != 0 || tilenca_schedule_new(NULL) != NULL) {
        return 1;
    }
    printf("%d %d %d; %s", TILENCA_SIMULATOR_ABI_VERSION == tilenca_simulator_abi_version(), states[0],
           states[1], tilenca_simulator_last_error());
    return 0;
}
""",
    "rollout": r"""
int main(void) {
    const float w1[5] = {1, 0, 0, 0, 0}, w2[1] = {1}, w3[1] = {1}, bias[1] = {0};
    const tilenca_rollout_network network = {1, 1, 1, 0, 100, w1, bias, w2, bias, w3, bias};
    const int64_t counts[1] = {1};
    const int32_t updating[1] = {0};
    int32_t perceived[5] = {0, 2, 2, 2, 2};
    const uint8_t delivered[1] = {1};
    const tilenca_rollout_schedule schedule = {1, 1, counts, updating, perceived, delivered};
    float rows[4][TILENCA_ROLLOUT_PADDING], state[1] = {3};
    const tilenca_rollout_tape tape = {rows[0], rows[1], rows[2], rows[3]};
    if (tilenca_rollout_forward(&network, &schedule, state, &tape) != 0) {
        printf("%s\n", tilenca_rollout_last_error());
        return 1;
    }
    perceived[4] = 3;
    if (tilenca_rollout_forward(&network, &schedule, state, &tape) == 0) {
        return 2;
    }
    printf("%d %.0f; %s", TILENCA_ROLLOUT_ABI_VERSION == tilenca_rollout_abi_version(), state[0],
           tilenca_rollout_last_error());
    return 0;
}
""",
}
PRINTED = {
    # 9 ms at 16 MHz, 100 ppm slow, and jumps of two cycles.
    "emulator": "1 143986 cycles; tile 2 does not exist; there are 2",
    "simulator": "1 8256 0; the setup is null",
    "rollout": "1 6; row of messages 3 does not exist; there are 3",
}


@pytest.mark.parametrize("compiler", [("gcc", "-std=c99", "-xc"), ("g++", "-std=c++17", "-xc++")])
@pytest.mark.parametrize("name", sorted(FOLDERS))
def test_a_header_compiles_alone(name: str, compiler: tuple[str, ...], tmp_path: Path) -> None:
    source = tmp_path / "alone.c"
    source.write_text(f'#include "tilenca/{name}.h"\n#include "tilenca/{name}.h"\n')
    search = ("-I", find(name).header.parents[1], "-I", SHARED)
    run_tool(*compiler, *STRICT, *search, "-c", source, "-o", tmp_path / "alone.o")


@pytest.mark.parametrize("name", sorted(FOLDERS))
def test_a_c_program_works_with_a_library(name: str, tmp_path: Path) -> None:
    source, program, image = tmp_path / "program.c", tmp_path / "program", tmp_path / "loop.hex"
    image.write_text(hex_record(0, 0, bytes.fromhex("ffcf")) + hex_record(1, 0, b""))
    source.write_text(f'#include "tilenca/{name}.h"\n#include <stdio.h>\n{PROGRAMS[name]}')
    library = find(name).library
    search = ("-I", find(name).header.parents[1], "-I", SHARED, library, f"-Wl,-rpath,{library.parent}")
    run_tool("gcc", "-std=c99", *STRICT, source, "-o", program, *search)
    assert run_tool(program, image) == PRINTED[name]
