// The south link's software UART on A14 and A15, both directions at once, 38,400 baud.
//
// To receive, the pin-change interrupt only stores timer 5's count in a ring of edges, and south_read() turns
// the edges into bytes. To send, timer 1, whose other half is red's PWM, toggles the line bit by bit from a
// prepared list.
//
// A line that changes faster than any UART's, such as a floating one near a motor, could keep the processor
// in that interrupt for ever. So after such noise the line is ignored for a while, the holdoff.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Counts of timer 1 per bit. 16 MHz / 38,400 would be 416.7. A slightly slow sender lets the receiver sample
// the stop bit well before the next start bit, even if that one comes early after an edge that came late. Of
// 416 to 420, 419 bears clocks that differ most, in both directions (docs/HARDWARE.md).
constexpr uint16_t kSouthBitCycles = 419;

// Takes timers 1 and 5 and the pin-change interrupt of port K.
void south_begin();

// The next byte received, if any. Call it until there is none at least every 6.6 ms: the ring holds 255
// edges, and a byte such as 0x55 has one per bit, every 26 us.
//
// Not inlined: in a larger function its state would not stay in registers, and it would take twice the
// cycles.
bool south_read(uint8_t* byte) __attribute__((noinline));

// Starts sending a frame of at most kMaxFrame bytes; only when south_idle().
void south_write(const uint8_t* bytes, uint8_t size);

// Whether the last frame is out.
bool south_idle();

// How often edges were lost because they were not read in time or came so fast that they must be noise. Stops
// at 65,535.
uint16_t south_overruns();

// How many bytes came without a stop bit, as usart_framing_errors(). Wraps.
uint16_t south_framing_errors();

} // namespace board
} // namespace tilenca
