#include "core/toggles.h"

namespace tilenca {

namespace {

constexpr uint8_t kMark = 1; // after the seven toggles of a byte

} // namespace

uint8_t toggles_of(const uint8_t* bytes, uint8_t size, uint8_t* toggles) {
    uint8_t* out = toggles;
    uint8_t bits = kMark; // the mark, which the seventh toggle pushes into bit 7, and the toggles so far
    for (uint8_t i = 0; i < size; ++i) {
        // Start bit in bit 0, stop bit in bit 9; the line is high before every byte.
        const uint16_t levels = 0x200 | static_cast<uint16_t>(bytes[i]) << 1;
        uint16_t changes = levels ^ (levels << 1 | 1);
        for (uint8_t bit = 0; bit < kBitsPerByte; ++bit, changes >>= 1) {
            const bool full = bits & 0x80 >> 1;
            bits = static_cast<uint8_t>(bits << 1 | (changes & 1));
            if (full) {
                *out++ = static_cast<uint8_t>(bits << 1 | kMark);
                bits = kMark;
            }
        }
    }
    if (bits != kMark) {
        while (!(bits & 0x80)) {
            bits = static_cast<uint8_t>(bits << 1);
        }
        *out++ = static_cast<uint8_t>(bits << 1 | kMark);
    }
    *out++ = kNoMoreToggles;
    return static_cast<uint8_t>(out - toggles);
}

} // namespace tilenca
