// Time, sleep, memory and the reset cause of the ATmega2560.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Starts the clock, on timer 4, and stops Arduino's millis(), whose long interrupt would delay the links'
// edges.
void clock_begin();

// Milliseconds since clock_begin(); wraps after 49 days. Call it at least every quarter of a second.
uint32_t now_ms();

// Sleeps until the millisecond after the one that now_ms() told last. Interrupts for single bits and bytes
// wake the processor, but not the main loop: what they bring has room for several milliseconds.
void sleep();

// Copies bytes from EEPROM, from address 0.
void read_eeprom(uint8_t* bytes, uint8_t size);

// MCUSR as the boot loader left it, cleared for the next time.
uint8_t take_reset_cause();

} // namespace board
} // namespace tilenca
