// The sending half of the software UART: when the line has to change, worked out before the first bit goes
// out.
#pragma once

#include <stdint.h>

#include "core/frame.h"

namespace tilenca {

constexpr uint8_t kBitsPerByte = 10; // start, eight data, stop
constexpr uint8_t kTogglesPerByte = 7;
constexpr uint8_t kNoMoreToggles = 0x80;
constexpr uint16_t kMaxToggleBytes =
    (kMaxFrame * kBitsPerByte + kTogglesPerByte - 1) / kTogglesPerByte + 1; // and the end

// Writes one bit per bit time, the first in bit 7 of toggles[0], seven to a byte: 1 where an idle (high) line
// must change to send `size` bytes, 8N1. Bit 0 of each byte is 1, so that whoever shifts its seven out to the
// left holds 0x80 when none is left. The last byte is filled with zeros. Then comes kNoMoreToggles. Returns
// the number of bytes written, at most kMaxToggleBytes.
uint8_t toggles_of(const uint8_t* bytes, uint8_t size, uint8_t* toggles);

} // namespace tilenca
