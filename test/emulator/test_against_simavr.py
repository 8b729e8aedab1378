"""Our core against libsimavr, which others wrote from the same data sheet."""

from pathlib import Path

import pytest
from conftest import ROOT, Compile, run_tool

INCLUDES = ("-I", ROOT / "tools" / "emulator" / "src", "-I", ROOT / "firmware" / "include")


@pytest.fixture(scope="module")
def differential(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = tmp_path_factory.mktemp("differential") / "differential"
    source = Path(__file__).parent / "differential.cpp"
    search = f"-Wl,-rpath,{library.parent}"
    run_tool(
        "g++", "-std=c++17", "-O1", *INCLUDES, source, "-o", program, library, search, "-lsimavr", "-lelf"
    )
    return program


@pytest.mark.parametrize("seed", [1, 2])
def test_random_instructions_have_the_same_result_flags_and_cycles(differential: Path, seed: int) -> None:
    said = run_tool(differential, "random", "300000", str(seed))
    # Every kind but those that stop, sleep or program: see differential.cpp.
    assert said == "300000 instructions of 99 kinds compared, 0 disagree\n"


PROGRAM = """
static uint32_t lfsr = 0xACE1u;
static uint8_t random_byte(void) { lfsr = lfsr * 1664525u + 1013904223u; return lfsr >> 24; }
static const uint16_t table[] PROGMEM = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3};
static uint8_t bytes[256];
static int depth(int n) { return n < 2 ? n : depth(n - 1) + depth(n - 2); }
static uint8_t (*volatile choose)(void) = random_byte;
int main(void) {
    float x = 1.0f;
    int64_t wide = 1;
    for (;;) {
        for (int i = 0; i < 256; i++) bytes[i] = choose();
        for (int i = 1; i < 256; i++)
            for (int j = i; j > 0 && (int8_t)bytes[j - 1] > (int8_t)bytes[j]; j--) {
                uint8_t swap = bytes[j]; bytes[j] = bytes[j - 1]; bytes[j - 1] = swap;
            }
        for (int i = 0; i < 16; i++) {
            x = x * 1.25f - pgm_read_word(&table[i]) / (x + 2.0f);
            wide = wide * -31 + bytes[i * 16] / 3 + (wide >> 7) % 1000;
        }
        result16[0] += depth(12) + (uint16_t)wide + (int16_t)x;
    }
}
"""


def test_a_program_takes_the_same_path_in_the_same_cycles(differential: Path, avr: Compile) -> None:
    said = run_tool(differential, "program", avr(PROGRAM), "3000000")
    assert said.startswith("3000000 instructions")
    assert said.endswith(" 0 disagree\n")
