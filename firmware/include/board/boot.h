// How the chip started, what it runs, how far its stack has been, and the watchdog that starts it again.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Bits of MCUSR. Where a boot loader has cleared it, as the stock one does, what survived in SRAM tells a
// power-on from a reset.
uint8_t reset_cause();
constexpr uint8_t kWatchdogReset = 1 << 3;

// Where in flash the program hung, as a byte address, if the watchdog's interrupt restarted it; else 0.
uint32_t hung_at();

// CRC-32 of the program as it lies in flash. Takes 57 cycles a byte, 0.14 s in all.
uint32_t firmware_id();

// From now on the program is restarted if it does not call watchdog_feed() for a quarter of a second.
void watchdog_begin();
void watchdog_feed();

// Looks at a few bytes of the stack's room, in every turn of the main loop. True when it has seen all.
bool stack_watch();

// Bytes of the stack's room that were never used, as of the last time that stack_watch() had seen all.
uint16_t stack_unused();

} // namespace board
} // namespace tilenca
