// Time, sleep, memory and the reset cause of the ATmega2560.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Milliseconds since boot; wraps after 49 days.
uint32_t now_ms();

// Sleeps until the next interrupt, at most about a millisecond.
void sleep();

// Copies bytes from EEPROM, from address 0.
void read_eeprom(uint8_t* bytes, uint8_t size);

// MCUSR as the boot loader left it, cleared for the next time.
uint8_t take_reset_cause();

} // namespace board
} // namespace tilenca
