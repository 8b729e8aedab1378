// The lines to the four neighbours, by side: which of them is a hardware UART is nobody else's business.
#pragma once

#include <stdint.h>

#include "core/side.h"

namespace tilenca {
namespace board {

void links_begin();

// The next byte from this side, if any. Ask every side at least every six milliseconds.
bool link_read(Side side, uint8_t* byte);

// Bytes, or edges of the line, lost since the start because there was no room for them.
uint16_t link_overruns(Side side);

// Whether the line is free for the next frame.
bool link_idle(Side side);

// Starts sending a frame of at most kMaxFrame bytes; only when link_idle().
void link_write(Side side, const uint8_t* bytes, uint8_t size);

} // namespace board
} // namespace tilenca
