// Time and sleep of the ATmega2560.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Counts of timer 4, the clock, per millisecond.
constexpr uint16_t kClockTop = F_CPU / 1000;

// Starts the clock on timer 4. Stops Arduino's millis(), whose long interrupt would delay the edges of the
// south link.
void clock_begin();

// Milliseconds since clock_begin(); wraps after 49 days. Call it at least every quarter of a second.
uint32_t now_ms();

// Half microseconds modulo 2^16, from timer 5, which the south link has started.
uint16_t stamp();

// Sleeps until the millisecond after the last result of now_ms(). Interrupts for single bits and bytes wake
// the processor, but not the main loop, since the queues have room for several milliseconds.
void sleep();

} // namespace board
} // namespace tilenca
