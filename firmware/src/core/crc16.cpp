#include "core/crc16.h"

namespace tilenca {

uint16_t crc16(const uint8_t* bytes, uint8_t size) {
    uint16_t crc = 0xFFFF;
    for (uint8_t i = 0; i < size; ++i) {
        // The polynomial has few terms: a whole byte folds in with shifts alone, without a table in flash.
        const uint8_t high = static_cast<uint8_t>(crc >> 8) ^ bytes[i];
        const uint16_t folded = high ^ (high >> 4);
        crc = static_cast<uint16_t>((crc << 8) ^ (folded << 12) ^ (folded << 5) ^ folded);
    }
    return crc;
}

} // namespace tilenca
