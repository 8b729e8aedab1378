// How the chip started, the id of its program, the use of its stack, and the watchdog.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Bits of MCUSR. The stock boot loader clears it; then a mark that survives a reset in SRAM tells a power-on
// from a reset.
uint8_t reset_cause();
constexpr uint8_t kWatchdogReset = 1 << 3;

// The byte address in flash where the program hung, if the watchdog's interrupt restarted it; otherwise 0.
uint32_t hung_at();

// CRC-32 of the program in flash. Takes 57 cycles a byte, 0.14 s in all.
uint32_t firmware_id();

// CRC-32 of the boot section of 8 KiB, where the lock bits do not hide it; 0: it is erased. Takes 30 ms.
uint32_t bootloader_id();

// Starts the watchdog, which restarts the program if watchdog_feed() is not called for a quarter of a second.
void watchdog_begin();
void watchdog_feed();

// Checks a few bytes of the stack's room; call it in every turn of the main loop. True when it has seen all.
bool stack_watch();

// Bytes of the stack's room that were never used, when stack_watch() had last seen all.
uint16_t stack_unused();

} // namespace board
} // namespace tilenca
