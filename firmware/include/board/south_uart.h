// The south link's software UART on A14 and A15, both directions at once, 38,400 baud.
//
// Receiving: the pin-change interrupt only stores timer 5's count in a ring of edges; read() turns them into
// bytes. Sending: timer 1 (whose other half is red's PWM) toggles the line bit by bit from a prepared list.
//
// A line that changes faster than any UART's, a floating one near a motor, say, could keep the processor in
// that interrupt for ever. So the line is not listened to for a while after such noise.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Counts of timer 1 per bit: 16 MHz / 38,400 is 416.7. Slightly slow on purpose: the receiver then samples
// the stop bit well before the next start bit, even if that one comes early after an edge that came late.
constexpr uint16_t kSouthBitCycles = 420;

// Takes timers 1 and 5 and the pin-change interrupt of port K.
void south_begin();

// The next byte received, if any. Call it until there is none at least every 6.6 ms: the ring holds 255
// edges, and a byte such as 0x55 has one per bit, every 26 us.
//
// Never inlined: in a larger function its state would not find registers, at twice the cycles.
bool south_read(uint8_t* byte) __attribute__((noinline));

// Starts sending a frame of at most kMaxFrame bytes; only when south_idle().
void south_write(const uint8_t* bytes, uint8_t size);

// Whether the last frame is out.
bool south_idle();

// How often edges were lost: they were not read in time, or they came too fast to be anything but noise.
// Stops at 65,535.
uint16_t south_overruns();

} // namespace board
} // namespace tilenca
