// A tile that never rests: sorting, floating point, 64-bit numbers, tables in flash, recursion.
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <stdint.h>

static uint32_t state = 0xACE1u;
static const uint16_t table[] PROGMEM = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3};
static uint8_t bytes[256];
static volatile uint16_t out;

static uint8_t random_byte(void) {
    state = state * 1664525u + 1013904223u;
    return state >> 24;
}

static int depth(int n) {
    return n < 2 ? n : depth(n - 1) + depth(n - 2);
}

static void sort(void) {
    for (int i = 1; i < 256; i++) {
        for (int j = i; j > 0 && (int8_t)bytes[j - 1] > (int8_t)bytes[j]; j--) {
            uint8_t swap = bytes[j];
            bytes[j] = bytes[j - 1];
            bytes[j - 1] = swap;
        }
    }
}

int main(void) {
    float x = 1.0f;
    int64_t wide = 1;
    for (;;) {
        for (int i = 0; i < 256; i++) {
            bytes[i] = random_byte();
        }
        sort();
        for (int i = 0; i < 16; i++) {
            x = x * 1.25f - pgm_read_word(&table[i]) / (x + 2.0f);
            wide = wide * -31 + bytes[i * 16] / 3 + (wide >> 7) % 1000;
        }
        out += depth(12) + (uint16_t)wide + (int16_t)x;
    }
}
