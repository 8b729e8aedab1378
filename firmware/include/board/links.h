// The lines to the four neighbours, by side. This hides which of them is a hardware UART.
#pragma once

#include <stdint.h>

#include "core/side.h"

namespace tilenca {
namespace board {

// Between south and north, and between east and west. The second rate is exactly 16 MHz / 128.
constexpr uint32_t kLinkBaud = 38400;
constexpr uint32_t kRowBaud = 125000;

// Take all bytes of every side at least this often, or some are lost. The longest turn of the main
// loop is 3.3 ms (docs/BENCHMARKS.md).
constexpr uint16_t kReadEveryUs = 5000;

void links_begin();

// East and west have a USART at both ends. North is connected to the software UART of the tile above.
constexpr uint32_t baud_of(Side side) {
    return side == Side::East || side == Side::West ? kRowBaud : kLinkBaud;
}

// Lets a side that has a USART begin anew at another rate.
void link_begin(Side side, uint32_t baud);

// The next byte from this side, if any.
bool link_read(Side side, uint8_t* byte);

// Whether the line is free for the next frame.
bool link_idle(Side side);

// Starts sending a frame of at most kMaxFrame bytes; only when link_idle().
void link_write(Side side, const uint8_t* bytes, uint8_t size);

// How many bytes were lost for want of room; on the south side, how often edges were lost for want of room or
// to noise. Stops at 65,535.
uint16_t link_overruns(Side side);

// How many bytes came without a stop bit. Stops at 65,535, but wraps on the south side.
uint16_t link_framing_errors(Side side);

// The sides whose receiving line is low now: one bit each, in the order N E S W.
uint8_t low_lines();

} // namespace board
} // namespace tilenca
