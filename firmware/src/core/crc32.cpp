#include "core/crc32.h"

#include "core/flash.h"

namespace tilenca {

namespace {

constexpr uint32_t kPolynomial = 0xEDB88320; // bits reversed

// What a byte does to the register. A table for half bytes would take a twentieth of the flash and three
// times the time, and a tile says nothing before it knows its id.
struct Table {
    uint32_t of_byte[256];

    constexpr Table() : of_byte() {
        for (uint16_t byte = 0; byte < 256; ++byte) {
            uint32_t value = byte;
            for (uint8_t bit = 0; bit < 8; ++bit) {
                value = value >> 1 ^ (value & 1 ? kPolynomial : 0);
            }
            of_byte[byte] = value;
        }
    }
};

constexpr Table kTable TILENCA_FLASH;

} // namespace

void Crc32::add(const uint8_t* bytes, uint8_t size) {
    const FlashView<uint32_t> of_byte(kTable.of_byte);
    uint32_t value = register_;
    for (uint8_t i = 0; i < size; ++i) {
        value = value >> 8 ^ of_byte[static_cast<uint8_t>(value) ^ bytes[i]];
    }
    register_ = value;
}

} // namespace tilenca
