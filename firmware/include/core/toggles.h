// The sending half of the software UART. It works out where the line changes before the first bit is sent.
#pragma once

#include <stdint.h>

#include "core/frame.h"

namespace tilenca {

constexpr uint8_t kBitsPerByte = 10; // start, eight data, stop
constexpr uint8_t kTogglesPerByte = 7;
constexpr uint8_t kNoMoreToggles = 0x80;
constexpr uint16_t kMaxToggleBytes =
    (kMaxFrame * kBitsPerByte + kTogglesPerByte - 1) / kTogglesPerByte + 1; // and the end

// Writes the toggles that send `size` bytes, 8N1, on an idle (high) line: one bit per bit time, 1 where the
// line changes. A byte has seven of them, the first in bit 7, and a 1 in bit 0: after seven shifts to the
// left it is 0x80. The last byte is filled up with zeros, and kNoMoreToggles follows. Returns the number of
// bytes written, at most kMaxToggleBytes.
uint8_t toggles_of(const uint8_t* bytes, uint8_t size, uint8_t* toggles);

} // namespace tilenca
