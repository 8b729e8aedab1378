// The south link's software UART on A14 and A15, both directions at once, 38,400 baud.
//
// Receiving: the pin-change interrupt only stores timer 5's count in a ring of edges; read() turns them into
// bytes. Sending: timer 1 (whose other half is red's PWM) toggles the line bit by bit from a prepared list.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Counts of timer 1 per bit: 16 MHz / 38,400 is 416.7. Slightly slow on purpose: the receiver then samples
// the stop bit well before the next start bit, even if that one comes early after an edge that came late.
constexpr uint16_t kSouthBitCycles = 420;

// Takes timers 1 and 5 and the pin-change interrupt of port K.
void south_begin();

// The next byte received, if any. Call it at least every six milliseconds, or edges are lost.
bool south_read(uint8_t* byte);

// Edges lost since the start, for want of room; said a little late.
uint16_t south_overruns();

// Starts sending a frame of at most kMaxFrame bytes; only when south_idle().
void south_write(const uint8_t* bytes, uint8_t size);

// Whether the last frame is out.
bool south_idle();

} // namespace board
} // namespace tilenca
