"""Our core against libsimavr, which others wrote from the same data sheet."""

from pathlib import Path

import pytest

from support.avr import Compile, compile_differential, run_tool


@pytest.fixture(scope="module")
def differential(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_differential(tmp_path_factory.mktemp("differential"))


@pytest.mark.parametrize("seed", [1, 2])
def test_random_instructions_have_the_same_result_flags_and_cycles(differential: Path, seed: int) -> None:
    said = run_tool(differential, "random", "300000", str(seed))
    # Every kind but those that stop, sleep or program: see differential.cpp.
    assert said == "300000 instructions of 103 kinds compared, 0 disagree\n"


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_streams_of_instructions_stay_together(differential: Path, seed: int) -> None:
    said = run_tool(differential, "stream", "1000000", str(seed))
    assert said == "1000000 instructions in a row, 0 disagree\n"


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


SPEAK = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
static int put(char c, FILE *f) { while (!(UCSR0A & 0x20)) { } UDR0 = c; return 0; }
static FILE out = FDEV_SETUP_STREAM(put, 0, _FDEV_SETUP_WRITE);
static void speak(void) { UBRR0 = 1; UCSR0A = 2; UCSR0B = 8; stdout = &out; }
"""

WHOLE_PROGRAMS = {
    "numbers": """
    int main(void) {
        speak();
        float x = 1; int64_t n = 1; uint32_t u = 12345;
        for (int i = 1; i < 40; i++) {
            x = x * 1.7f + 1.0f / i; n = n * -7 + i; u = u * 1664525u + 1013904223u;
            printf("%d %g %ld %lu %lx|", i, (double)x, (long)(n >> 13), u, u / (i * 3u));
        }
        for (;;) { }
    }""",
    "heap": """
    static uint32_t seed = 1;
    static uint16_t draw(uint16_t n) { seed = seed * 1103515245u + 12345; return (seed >> 16) % n; }
    static int order(const void *a, const void *b) { return *(const int16_t *)a - *(const int16_t *)b; }
    int main(void) {
        speak();
        static uint8_t *blocks[20]; static uint8_t sizes[20];
        for (int turn = 0; turn < 400; turn++) {
            uint8_t i = draw(20);
            for (uint8_t k = 0; blocks[i] && k < sizes[i]; k++) if (blocks[i][k] != i) printf("broken!");
            free(blocks[i]);
            sizes[i] = 1 + draw(120); blocks[i] = malloc(sizes[i]);
            if (blocks[i]) memset(blocks[i], i, sizes[i]); else printf("full ");
        }
        int16_t list[100];
        for (int i = 0; i < 100; i++) list[i] = draw(30000);
        qsort(list, 100, 2, order);
        for (int i = 0; i < 100; i++) printf("%d ", list[i]);
        for (;;) { }
    }""",
    "jumps": """
    static jmp_buf place;
    static int (*volatile table[3])(int);
    static int one(int n) { if (n > 5) longjmp(place, n); return n + 1; }
    static int two(int n) { return table[n & 2](n) * 2; }
    static int three(int n) { return n < 2 ? n : three(n - 1) + three(n - 2); }
    int main(void) {
        speak(); table[0] = one; table[1] = two; table[2] = three;
        for (int n = 0; n < 12; n++) {
            int came = setjmp(place);
            if (came) printf("back %d;", came); else printf("%d %d;", table[n % 3](n), table[2](n));
        }
        for (;;) { }
    }""",
    "far": """
    /* Code and tables beyond 128 KiB: EICALL by trampolines, ELPM. */
    __attribute__((section(".far"), noinline, used)) static int distant(int n) { return n * 3 + 1; }
    static const uint8_t table[] __attribute__((section(".fartable"))) = {9, 8, 7, 6, 5};
    static int (*volatile call)(int) = distant;
    int main(void) {
        speak();
        for (int n = 0; n < 5; n++) printf("%d %u;", call(n), pgm_read_byte_far(0x30000ul + n));
        printf("%lx", pgm_read_dword_far(0x30001ul));
        for (;;) { asm volatile("" :: "r"(table)); }
    }""",
    "eeprom": """
    int main(void) {
        speak();
        for (uint16_t n = 0; n < 300; n += 3) eeprom_write_byte((uint8_t *)(n * 13 % 4096), n);
        eeprom_write_dword((uint32_t *)4092, 0xCAFEBABE);
        for (uint16_t n = 0; n < 300; n += 3) printf("%u ", eeprom_read_byte((uint8_t *)(n * 13 % 4096)));
        eeprom_update_byte((uint8_t *)4092, 0xBE);
        printf("%lx", eeprom_read_dword((uint32_t *)4092));
        for (;;) { }
    }""",
    "interrupts": """
    static volatile uint16_t overflows, compares;
    ISR(TIMER1_OVF_vect) { overflows++; }
    ISR(TIMER3_COMPA_vect) { compares++; }
    ISR(BADISR_vect) { printf("bad"); }
    int main(void) {
        speak();
        TCCR1B = 1; TIMSK1 = 1; OCR3A = 999; TCCR3B = 0x0A; TIMSK3 = 2; sei();
        while (compares < 250) { }
        printf("%u %u", overflows, compares);
        for (;;) { }
    }""",
}


@pytest.mark.parametrize("name", list(WHOLE_PROGRAMS))
def test_whole_programs_say_and_keep_the_same(differential: Path, avr: Compile, name: str) -> None:
    options = ["-Wl,-u,vfprintf", "-lprintf_flt", "-lm", "-Wno-unused"]
    options += ["-Wl,--section-start=.far=0x24000", "-Wl,--section-start=.fartable=0x30000"]
    elf = avr(SPEAK + WHOLE_PROGRAMS[name], *(options if name == "far" else options[:4]))
    said = run_tool(differential, "whole", elf, "16")
    count, _, rest = said.partition(" ")
    assert int(count) >= 6
    assert rest == "bytes said, the same\n"
