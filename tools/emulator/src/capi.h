// The emulator as a C library: what host/tilenca/emulator/array.py calls. Times are in seconds since the array
// began.
//
// Functions that can fail return null or a negative number, and tilenca_last_error says why in one line.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct tilenca_array tilenca_array;

const char* tilenca_last_error(void);

// bootloader: an image for the boot section, from which the chips then start; null: none.
tilenca_array* tilenca_array_new(const char* image, const char* bootloader, unsigned tiles, const double* ppm,
                                 const double* switch_on_s);
void tilenca_array_free(tilenca_array* array);
unsigned tilenca_array_size(tilenca_array* array);
// Returns the new tile's index.
unsigned tilenca_array_add_tile(tilenca_array* array, double ppm, double switch_on_s);
// The others keep their indices.
void tilenca_array_remove_tile(tilenca_array* array, unsigned tile);
// Cables: laid, taken away, cut (0) and mended (1). A side is one of N E S W, 0 to 3.
int tilenca_array_link(tilenca_array* array, unsigned tile, unsigned side, unsigned other_tile,
                       unsigned other_side);
int tilenca_array_unlink(tilenca_array* array, unsigned tile, unsigned side);
int tilenca_array_connect(tilenca_array* array, unsigned tile, unsigned side, int connected);
// What goes wrong in the direction that leaves that side: shares of bytes and of data bits, a delay; baud 0:
// that of the USART at either end. Counts: bytes seen, bytes lost, bits flipped, while there was a share of
// either.
int tilenca_array_set_fault(tilenca_array* array, unsigned tile, unsigned side, double loss, double flip,
                            double delay_s, double baud, uint64_t seed);
int tilenca_array_fault_counts(tilenca_array* array, unsigned tile, unsigned side, uint64_t counts[3]);
// Threads change how long it takes, and nothing else.
void tilenca_array_set_threads(tilenca_array* array, unsigned threads);
// Returns how many tiles stand still after a fault. Ends early where a tile meets a breakpoint.
int tilenca_array_run(tilenca_array* array, double seconds);
double tilenca_array_time(tilenca_array* array);
// The first tile from `first` on that a breakpoint has halted; -1: none.
int tilenca_array_halted(tilenca_array* array, unsigned first);
// A snapshot; the bytes are valid until the next call of this.
size_t tilenca_array_save(tilenca_array* array, const uint8_t** bytes);
int tilenca_array_load(tilenca_array* array, const uint8_t* bytes, size_t count);
// Symbols of the image: data memory from 0x800000 on, flash from 0. Function: "" where there is none.
int tilenca_array_symbol(tilenca_array* array, const char* name, uint32_t* address, uint32_t* size);
const char* tilenca_array_function_at(tilenca_array* array, uint32_t address);

// "" while the tile runs.
const char* tilenca_tile_fault(tilenca_array* array, unsigned tile);
// The index-th thing the tile's program asked for that is not modelled; null: no more.
const char* tilenca_tile_warning(tilenca_array* array, unsigned tile, unsigned index);
int tilenca_tile_segments(tilenca_array* array, unsigned tile);
int tilenca_tile_leds(tilenca_array* array, unsigned tile);
void tilenca_tile_rgb(tilenca_array* array, unsigned tile, uint8_t duty[3]);
void tilenca_tile_press_button(tilenca_array* array, unsigned tile, int pressed);
// cause: 2 the reset pin, 4 brown-out.
void tilenca_tile_reset(tilenca_array* array, unsigned tile, unsigned cause);
void tilenca_tile_set_power(tilenca_array* array, unsigned tile, int on);
int tilenca_tile_is_powered(tilenca_array* array, unsigned tile);
// From now on the clock error grows by so much a second.
void tilenca_tile_set_drift(tilenca_array* array, unsigned tile, double ppm_per_s);
// As a programmer sets them; the chip starts anew.
void tilenca_tile_set_fuses(tilenca_array* array, unsigned tile, unsigned low, unsigned high,
                            unsigned extended, unsigned lock);
// A pin by port letter (A to L, but no I) and bit: its level, the share of time it is high, and holding it
// from outside. All fail for a pin that does not exist.
int tilenca_tile_pin(tilenca_array* array, unsigned tile, char port, unsigned bit);
double tilenca_tile_duty(tilenca_array* array, unsigned tile, char port, unsigned bit);
int tilenca_tile_hold_pin(tilenca_array* array, unsigned tile, char port, unsigned bit, int level);
// What an analog channel (0..15) converts to, 0..1023.
void tilenca_tile_set_analog(tilenca_array* array, unsigned tile, unsigned channel, unsigned value);
void tilenca_tile_set_adc_noise(tilenca_array* array, unsigned tile, double deviation, uint64_t seed);
// The analog comparator's inputs, in 1024ths of the supply.
void tilenca_tile_set_comparator(tilenca_array* array, unsigned tile, unsigned ain0, unsigned ain1);
void tilenca_tile_set_spi_loopback(tilenca_array* array, unsigned tile, int on);
// A change of an input's level ahead of time, at a cycle of the tile's clock.
int tilenca_tile_push_edge(tilenca_array* array, unsigned tile, char port, unsigned bit, uint64_t cycle,
                           int level);

void tilenca_tile_send(tilenca_array* array, unsigned tile, const uint8_t* bytes, size_t count);
// Takes at most `room` bytes out of what the tile sent, with the time each arrived; returns how many.
size_t tilenca_tile_receive(tilenca_array* array, unsigned tile, uint8_t* bytes, double* times, size_t room);
// From the change number `first` on; returns how many there are in all.
size_t tilenca_tile_display_changes(tilenca_array* array, unsigned tile, size_t first, double* times,
                                    uint8_t* segments, size_t room);
int tilenca_tile_read_eeprom(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                             unsigned count);
int tilenca_tile_write_eeprom(tilenca_array* array, unsigned tile, unsigned address, const uint8_t* bytes,
                              unsigned count);
// Data space as it is stored: registers, I/O, SRAM.
int tilenca_tile_read_memory(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                             unsigned count);
int tilenca_tile_read_flash(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                            unsigned count);
int tilenca_tile_write_memory(tilenca_array* array, unsigned tile, unsigned address, const uint8_t* bytes,
                              unsigned count);
// Cycles since it was first switched on: in all, asleep, and without power.
void tilenca_tile_cycles(tilenca_array* array, unsigned tile, uint64_t cycles[3]);
// The stack pointer, the lowest address the stack has used, and the first one it may.
void tilenca_tile_stack(tilenca_array* array, unsigned tile, unsigned addresses[3]);
// Byte address of the next instruction.
uint32_t tilenca_tile_pc(tilenca_array* array, unsigned tile);

// --- for debuggers; addresses are bytes of flash, even ---
void tilenca_tile_set_pc(tilenca_array* array, unsigned tile, uint32_t address);
unsigned tilenca_tile_status(tilenca_array* array, unsigned tile);
void tilenca_tile_set_status(tilenca_array* array, unsigned tile, unsigned value);
int tilenca_tile_set_breakpoint(tilenca_array* array, unsigned tile, uint32_t address, int set);
// Halts the tile where it stands, or executes one instruction of a halted one, or lets it go on. A step
// returns 0 if the tile sleeps on after a second, or another one has halted first.
void tilenca_tile_halt(tilenca_array* array, unsigned tile);
int tilenca_tile_step(tilenca_array* array, unsigned tile);
void tilenca_tile_resume(tilenca_array* array, unsigned tile);
// Notes the cycle at which the instruction at an address begins, every time.
int tilenca_tile_set_mark(tilenca_array* array, unsigned tile, uint32_t address, int set);
// Takes at most `room` notes; returns how many.
size_t tilenca_tile_marks(tilenca_array* array, unsigned tile, uint32_t* addresses, uint64_t* cycles,
                          size_t room);

// --- probes: eyes on a pin; they are numbered from 0 ---
// The pin a side sends on (0) or receives on (1).
void tilenca_side_pin(unsigned side, int receives, char* port, unsigned* bit);
// baud: below 0, the edges are kept; 0, bytes are read at the rate of the pin's USART; above, at that rate.
int tilenca_probe_new(tilenca_array* array, unsigned tile, char port, unsigned bit, double baud);
void tilenca_probe_free(tilenca_array* array, unsigned probe);
// The level before the first edge that has not been taken yet.
int tilenca_probe_level(tilenca_array* array, unsigned probe);
// Take at most `room` edges or bytes, each with its time; return how many.
size_t tilenca_probe_edges(tilenca_array* array, unsigned probe, double* times, uint8_t* levels, size_t room);
size_t tilenca_probe_bytes(tilenca_array* array, unsigned probe, double* times, uint8_t* values,
                           uint8_t* framing_errors, size_t room);

#ifdef __cplusplus
}
#endif
