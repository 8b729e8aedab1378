#include "core/toggles.h"

namespace tilenca {

uint8_t toggles_of(const uint8_t* bytes, uint8_t size, uint8_t* toggles) {
    uint8_t written = 0;
    uint8_t bits = 0;
    uint8_t count = 0; // of bits in `bits`
    for (uint8_t i = 0; i < size; ++i) {
        // Start bit in bit 0, stop bit in bit 9; the line is high before every byte.
        const uint16_t levels = 0x200 | static_cast<uint16_t>(bytes[i]) << 1;
        uint16_t changes = levels ^ (levels << 1 | 1);
        for (uint8_t bit = 0; bit < kBitsPerByte; ++bit, changes >>= 1) {
            bits = static_cast<uint8_t>(bits << 1 | (changes & 1));
            if (++count == 8) {
                toggles[written++] = bits;
                count = 0;
            }
        }
    }
    if (count != 0) {
        toggles[written++] = static_cast<uint8_t>(bits << (8 - count));
    }
    return written;
}

} // namespace tilenca
