// The sending half of the software UART: when the line has to change, worked out before the first bit goes
// out.
#pragma once

#include <stdint.h>

#include "core/frame.h"

namespace tilenca {

constexpr uint8_t kBitsPerByte = 10; // start, eight data, stop
constexpr uint8_t kMaxToggleBytes = (kMaxFrame * kBitsPerByte + 7) / 8;

// Writes one bit per bit time, the first in bit 7 of toggles[0]: 1 where an idle (high) line must change to
// send `size` bytes, 8N1. Returns the number of bytes written, at most kMaxToggleBytes; the last is filled
// with zeros.
uint8_t toggles_of(const uint8_t* bytes, uint8_t size, uint8_t* toggles);

} // namespace tilenca
