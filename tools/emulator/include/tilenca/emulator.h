// The emulator: arrays of ATmega2560 boards ("tiles"), wired side to side, that run a firmware image cycle by
// cycle. Plain C99, for any language.
//
// Conventions. Times are in seconds since the array began. Tiles count from 0; a side is one of N E S W, 0 to
// 3; a pin is a port letter, A to L without I, and a bit, 0 to 7. A function without another result returns
// 0. A function that fails returns null or a negative number, changes nothing unless its comment says so, and
// tilenca_emulator_last_error says why in one line. Every index and range is checked; a null
// array fails, too. An array belongs to one thread at a time; different arrays know nothing of each other.
#ifndef TILENCA_EMULATOR_H
#define TILENCA_EMULATOR_H

#include <stddef.h>
#include <stdint.h>

#include "tilenca/api.h"

#ifdef __cplusplus
extern "C" {
#endif

// Grows with every change after which callers must be compiled or written anew.
enum { TILENCA_EMULATOR_ABI_VERSION = 2 };

typedef struct tilenca_array tilenca_array;

// What goes wrong in one direction of a cable.
typedef struct tilenca_wire_fault {
    double loss;    // share of the bytes that never arrive, 0..1
    double flip;    // share of the data bits that arrive inverted, 0..1
    double delay_s; // more than any cable takes, 0..1
    double baud;    // of the bytes on it; 0: that of the USART at either end
} tilenca_wire_fault;

// What a direction of a cable has done while it had a loss or a flip.
typedef struct tilenca_wire_counts {
    uint64_t bytes;   // entered it
    uint64_t lost;    // of them
    uint64_t flipped; // data bits
} tilenca_wire_counts;

// Cycles of a tile's clock since it was first switched on.
typedef struct tilenca_cycles {
    uint64_t total;  // those without power included
    uint64_t asleep; // of them
    uint64_t off;    // of them: without power
} tilenca_cycles;

// Addresses of data memory.
typedef struct tilenca_stack {
    uint32_t pointer;
    uint32_t deepest; // the lowest address the stack has used
    uint32_t floor;   // the lowest it may
} tilenca_stack;

// What a tile without power does to the inputs of its neighbours: its pins load the wires.
enum { TILENCA_PULLS_LOW, TILENCA_PULLS_TO_THE_MIDDLE, TILENCA_PULLS_HIGH, TILENCA_LEAVES_OPEN };

// How far tiles differ from ideal ones.
typedef struct tilenca_hardware {
    uint64_t seed;         // decides all that is left to chance below; each tile draws its own
    double watchdog_error; // the watchdog's clock is off by a share of up to so much, 0..0.5
    int floating_inputs;   // an input that neither its pull-up nor anybody outside drives reads 1: noise; 0:
                           // high
    int sram_noise;        // at power-on SRAM and registers hold 1: noise; 0: zeros
    int start_up;          // a program begins 1: after the start-up time that the fuses say; 0: at once
    int unpowered;         // of the enumeration above
} tilenca_hardware;

// Bit of MCUSR that a reset sets.
enum { TILENCA_RESET_EXTERNAL = 2, TILENCA_RESET_BROWN_OUT = 4 };

// --- the library ---

// TILENCA_EMULATOR_ABI_VERSION of the header that the library was compiled with.
TILENCA_API int tilenca_emulator_abi_version(void);
// The bytes of a structure above, by its name ("tilenca_cycles"); 0: there is none of that name.
TILENCA_API size_t tilenca_emulator_size_of(const char* structure);
// The message of this thread's last failure; valid until the next one fails.
TILENCA_API const char* tilenca_emulator_last_error(void);

// --- arrays ---

// Tiles that run an ELF or Intel HEX file. `bootloader`: a file for the boot section, where the chips then
// start after every reset; null: none. `ppm` [tiles]: each tile's clock error. `switch_on_s` [tiles]: 0 to
// 1e9. Free the result with tilenca_array_free.
TILENCA_API tilenca_array* tilenca_array_new(const char* image, const char* bootloader, unsigned tiles,
                                             const double* ppm, const double* switch_on_s);
// Null is allowed.
TILENCA_API void tilenca_array_free(tilenca_array* array);
// How many tiles it has.
TILENCA_API int tilenca_array_size(tilenca_array* array);
// Returns the new tile's index. All the time since `switch_on_s` (0 to 1e9) is run for it first.
TILENCA_API int tilenca_array_add_tile(tilenca_array* array, double ppm, double switch_on_s);
// Switches a tile off for good and takes its cables away. The others keep their indices, and so does it.
TILENCA_API int tilenca_array_remove_tile(tilenca_array* array, unsigned tile);
// How long a cable takes, 20 us to 260 us (usually the most); before the array runs. Tiles run in turns that
// are a little shorter: longer ones cost less. A snapshot brings its own along.
TILENCA_API int tilenca_array_set_cable_delay(tilenca_array* array, double seconds);
// Before cables are laid and the array runs; without this call all is ideal, and a tile without power pulls
// high.
TILENCA_API int tilenca_array_set_hardware(tilenca_array* array, const tilenca_hardware* hardware);
// How many threads share the work, 1 to 1024. They change how long it takes, and nothing else.
TILENCA_API int tilenca_array_set_threads(tilenca_array* array, unsigned threads);
// Runs all tiles, in steps of 16 us; returns how many stand still after a fault. Ends early where a tile
// meets a breakpoint.
TILENCA_API int tilenca_array_run(tilenca_array* array, double seconds);
TILENCA_API double tilenca_array_time(tilenca_array* array);
// A snapshot of all that decides about the future: sets `bytes`, valid until the next call of this or until
// the array is freed, and returns how many there are.
TILENCA_API ptrdiff_t tilenca_array_save(tilenca_array* array, const uint8_t** bytes);
// Goes to the moment of a snapshot of this array, or of another with the same image. An array that this
// fails for is of no use, unless another call succeeds. Probes of tiles that are no more are freed.
TILENCA_API int tilenca_array_load(tilenca_array* array, const uint8_t* bytes, size_t count);
// A symbol of the image. Addresses: data memory from 0x800000 on, bytes of flash from 0.
TILENCA_API int tilenca_array_symbol(tilenca_array* array, const char* name, uint32_t* address,
                                     uint32_t* size);
// The function that contains a byte of flash; "": none. Valid until the next call of this.
TILENCA_API const char* tilenca_array_function_at(tilenca_array* array, uint32_t address);

// --- translated blocks: the same results in less time ---

// Counts instructions from now on, for tilenca_array_translated; before the array runs, on one thread.
TILENCA_API int tilenca_array_count_instructions(tilenca_array* array);
// C++ that does what the instructions that were counted most do, for a compiler that makes a shared library
// of it. Valid until the next call of this.
TILENCA_API const char* tilenca_array_translated(tilenca_array* array);
// Executes the blocks of such a library, of the same image and version of the emulator. Null: those that the
// emulator itself was linked with, as in a browser.
TILENCA_API int tilenca_array_use_translation(tilenca_array* array, const char* path);

// --- cables ---

// Lays a cable between sides of two tiles; fails where one is already.
TILENCA_API int tilenca_array_link(tilenca_array* array, unsigned tile, unsigned side, unsigned other_tile,
                                   unsigned other_side);
// Takes the cable at a side away.
TILENCA_API int tilenca_array_unlink(tilenca_array* array, unsigned tile, unsigned side);
// Cuts the cable at a side (0), or mends it (1).
TILENCA_API int tilenca_array_connect(tilenca_array* array, unsigned tile, unsigned side, int connected);
// What goes wrong from now on in the direction that leaves a side. `seed` decides which bytes and bits.
TILENCA_API int tilenca_array_set_fault(tilenca_array* array, unsigned tile, unsigned side,
                                        const tilenca_wire_fault* fault, uint64_t seed);
TILENCA_API int tilenca_array_fault_counts(tilenca_array* array, unsigned tile, unsigned side,
                                           tilenca_wire_counts* counts);

// --- a tile as people see and touch it ---

// What stopped it: tile, address, function, fact; "" while it runs. Valid until the next call for this tile,
// or until a tile is added or a snapshot loaded.
TILENCA_API const char* tilenca_tile_fault(tilenca_array* array, unsigned tile);
// Functions of the chip that its program asked for and that are not modelled: how many, and each, counted
// from 0. The text is valid until the array runs again.
TILENCA_API int tilenca_tile_warnings(tilenca_array* array, unsigned tile);
TILENCA_API const char* tilenca_tile_warning(tilenca_array* array, unsigned tile, unsigned index);
// Lit segments: bit 0 = a ... bit 6 = g, bit 7 = dp.
TILENCA_API int tilenca_tile_segments(tilenca_array* array, unsigned tile);
// Copies at most `room` changes of the display, beginning with number `first`; returns how many there are in
// all. With a `room` of 0 both arrays may be null.
TILENCA_API ptrdiff_t tilenca_tile_display_changes(tilenca_array* array, unsigned tile, size_t first,
                                                   double* times, uint8_t* segments, size_t room);
// The debug LEDs: bit 0..3 = N E S W.
TILENCA_API int tilenca_tile_leds(tilenca_array* array, unsigned tile);
// Duty of red, green and blue, 0..255.
TILENCA_API int tilenca_tile_rgb(tilenca_array* array, unsigned tile, uint8_t duty[3]);
TILENCA_API int tilenca_tile_press_button(tilenca_array* array, unsigned tile, int pressed);
// From outside, by a cause of the enumeration above; nothing happens to a tile without power.
TILENCA_API int tilenca_tile_reset(tilenca_array* array, unsigned tile, unsigned cause);
TILENCA_API int tilenca_tile_set_power(tilenca_array* array, unsigned tile, int on);
TILENCA_API int tilenca_tile_is_powered(tilenca_array* array, unsigned tile);
// From now on the clock error grows by so much a second, to half of the nominal rate at most, either way.
TILENCA_API int tilenca_tile_set_drift(tilenca_array* array, unsigned tile, double ppm_per_s);
// From now on it is by so much faster than its error and drift make it; at most 100000 either way.
TILENCA_API int tilenca_tile_set_skew(tilenca_array* array, unsigned tile, double ppm);
// Bytes, as a programmer sets them; the chip starts anew.
TILENCA_API int tilenca_tile_set_fuses(tilenca_array* array, unsigned tile, unsigned low, unsigned high,
                                       unsigned extended, unsigned lock);
// Queues bytes for its USB serial; they arrive while the array runs, at the tile's speed.
TILENCA_API int tilenca_tile_send(tilenca_array* array, unsigned tile, const uint8_t* bytes, size_t count);
// Takes at most `room` bytes of what it sent on USB, with the time each arrived; returns how many.
TILENCA_API ptrdiff_t tilenca_tile_receive(tilenca_array* array, unsigned tile, uint8_t* bytes, double* times,
                                           size_t room);

// --- pins ---

// Its level: 0 or 1.
TILENCA_API int tilenca_tile_pin(tilenca_array* array, unsigned tile, char port, unsigned bit);
// The share of time (0..1) an output is high under its timer's PWM; 0 for an input.
TILENCA_API double tilenca_tile_duty(tilenca_array* array, unsigned tile, char port, unsigned bit);
// Drives an input from outside: 0 or 1; below 0: lets it go. A pin with a cable hears nothing of it
// meanwhile.
TILENCA_API int tilenca_tile_hold_pin(tilenca_array* array, unsigned tile, char port, unsigned bit,
                                      int level);
// A change of an input's level ahead of time, at a cycle of the tile's clock. From the first call on the pin
// is driven, and high before that change.
TILENCA_API int tilenca_tile_push_edge(tilenca_array* array, unsigned tile, char port, unsigned bit,
                                       uint64_t cycle, int level);
// What an analog channel, 0 to 15, converts to: 0 to 1023.
TILENCA_API int tilenca_tile_set_analog(tilenca_array* array, unsigned tile, unsigned channel,
                                        unsigned value);
// The supply, 1.8 to 5.5 V, 5 at the start. The ADC and the comparator see it beside the bandgap's 1.1 V; the
// chip runs on at any.
TILENCA_API int tilenca_tile_set_supply(tilenca_array* array, unsigned tile, double volts);
// Conversions are off by a normal deviate, in units of the result's lowest bit.
TILENCA_API int tilenca_tile_set_adc_noise(tilenca_array* array, unsigned tile, double deviation,
                                           uint64_t seed);
// The analog comparator's inputs, in 1024ths of the supply.
TILENCA_API int tilenca_tile_set_comparator(tilenca_array* array, unsigned tile, unsigned ain0,
                                            unsigned ain1);
// Joins MOSI and MISO (1), or parts them (0).
TILENCA_API int tilenca_tile_set_spi_loopback(tilenca_array* array, unsigned tile, int on);
// The pin that a side sends on (`receives` 0) or receives on (1).
TILENCA_API int tilenca_side_pin(unsigned side, int receives, char* port, unsigned* bit);

// --- memories; a range must lie within: EEPROM 4096 bytes, data space 0x2200, flash 0x40000 ---

TILENCA_API int tilenca_tile_read_eeprom(tilenca_array* array, unsigned tile, unsigned address,
                                         uint8_t* bytes, unsigned count);
TILENCA_API int tilenca_tile_write_eeprom(tilenca_array* array, unsigned tile, unsigned address,
                                          const uint8_t* bytes, unsigned count);
// The data space as it is stored: registers, I/O, SRAM. Peripherals do not notice what is written.
TILENCA_API int tilenca_tile_read_memory(tilenca_array* array, unsigned tile, unsigned address,
                                         uint8_t* bytes, unsigned count);
TILENCA_API int tilenca_tile_write_memory(tilenca_array* array, unsigned tile, unsigned address,
                                          const uint8_t* bytes, unsigned count);
TILENCA_API int tilenca_tile_read_flash(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                                        unsigned count);

// --- for measuring and debugging; addresses of code are bytes of flash, and even ---

TILENCA_API int tilenca_tile_cycles(tilenca_array* array, unsigned tile, tilenca_cycles* cycles);
TILENCA_API int tilenca_tile_stack(tilenca_array* array, unsigned tile, tilenca_stack* stack);
// Address of the next instruction.
TILENCA_API int tilenca_tile_pc(tilenca_array* array, unsigned tile);
TILENCA_API int tilenca_tile_set_pc(tilenca_array* array, unsigned tile, uint32_t address);
// SREG.
TILENCA_API int tilenca_tile_status(tilenca_array* array, unsigned tile);
TILENCA_API int tilenca_tile_set_status(tilenca_array* array, unsigned tile, unsigned value);
TILENCA_API int tilenca_tile_set_breakpoint(tilenca_array* array, unsigned tile, uint32_t address, int set);
// Whether it stands before a breakpoint, or was halted: 0 or 1.
TILENCA_API int tilenca_tile_is_halted(tilenca_array* array, unsigned tile);
// Halts it where it stands.
TILENCA_API int tilenca_tile_halt(tilenca_array* array, unsigned tile);
// Executes one instruction of a halted tile; the others catch up. Returns 1, or 0 if it sleeps on after a
// second or another tile has halted first. It is halted afterwards.
TILENCA_API int tilenca_tile_step(tilenca_array* array, unsigned tile);
// Lets a halted tile go on with the next run.
TILENCA_API int tilenca_tile_resume(tilenca_array* array, unsigned tile);
// Notes the cycle at which the instruction at an address begins, every time, or no longer.
TILENCA_API int tilenca_tile_set_mark(tilenca_array* array, unsigned tile, uint32_t address, int set);
// Takes at most `room` notes; returns how many.
TILENCA_API ptrdiff_t tilenca_tile_marks(tilenca_array* array, unsigned tile, uint32_t* addresses,
                                         uint64_t* cycles, size_t room);

// --- probes, which look at a pin; an array numbers them from 0 ---

// `baud` below 0: keeps edges; 0: reads bytes at the rate of the pin's USART; above: reads bytes at that
// rate. Returns its number.
TILENCA_API int tilenca_probe_new(tilenca_array* array, unsigned tile, char port, unsigned bit, double baud);
// It keeps its number; a freed probe returns nothing, and freeing it again does nothing.
TILENCA_API int tilenca_probe_free(tilenca_array* array, unsigned probe);
// The level before the first edge that was not taken yet: 0 or 1; 0 where it was freed.
TILENCA_API int tilenca_probe_level(tilenca_array* array, unsigned probe);
// Take at most `room` edges or bytes, each with its time; return how many.
TILENCA_API ptrdiff_t tilenca_probe_edges(tilenca_array* array, unsigned probe, double* times,
                                          uint8_t* levels, size_t room);
TILENCA_API ptrdiff_t tilenca_probe_bytes(tilenca_array* array, unsigned probe, double* times,
                                          uint8_t* values, uint8_t* framing_errors, size_t room);

#ifdef __cplusplus
}
#endif

#endif
