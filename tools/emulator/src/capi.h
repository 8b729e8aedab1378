// The emulator as a C library: what host/tilenca/emulator.py calls. Times are in seconds since the array
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
int tilenca_array_link(tilenca_array* array, unsigned tile, unsigned side, unsigned other_tile,
                       unsigned other_side);
// Returns how many tiles stand still after a fault.
int tilenca_array_run(tilenca_array* array, double seconds);
double tilenca_array_time(tilenca_array* array);

// "" while the tile runs.
const char* tilenca_tile_fault(tilenca_array* array, unsigned tile);
// The index-th thing the tile's program asked for that is not modelled; null: no more.
const char* tilenca_tile_warning(tilenca_array* array, unsigned tile, unsigned index);
int tilenca_tile_segments(tilenca_array* array, unsigned tile);
int tilenca_tile_leds(tilenca_array* array, unsigned tile);
void tilenca_tile_rgb(tilenca_array* array, unsigned tile, uint8_t duty[3]);
void tilenca_tile_press_button(tilenca_array* array, unsigned tile, int pressed);
void tilenca_tile_reset(tilenca_array* array, unsigned tile);
// A pin by port letter (A to L, but no I) and bit: its level, the share of time it is high, and holding it
// from outside. All fail for a pin that does not exist.
int tilenca_tile_pin(tilenca_array* array, unsigned tile, char port, unsigned bit);
double tilenca_tile_duty(tilenca_array* array, unsigned tile, char port, unsigned bit);
int tilenca_tile_hold_pin(tilenca_array* array, unsigned tile, char port, unsigned bit, int level);
// What an analog channel (0..15) converts to, 0..1023.
void tilenca_tile_set_analog(tilenca_array* array, unsigned tile, unsigned channel, unsigned value);
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
void tilenca_tile_cycles(tilenca_array* array, unsigned tile, uint64_t* total, uint64_t* asleep);
// Byte address of the next instruction.
uint32_t tilenca_tile_pc(tilenca_array* array, unsigned tile);

#ifdef __cplusplus
}
#endif
