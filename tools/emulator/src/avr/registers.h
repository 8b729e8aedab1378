// What registers.inc says, by address.
#pragma once

#include "avr/cpu.h"

#include <array>
#include <cstdint>

namespace tilenca::avr {

struct RegisterTable {
    std::array<uint8_t, kSramStart> reset{};
    std::array<uint8_t, kSramStart> implemented{}; // bits that exist; none at reserved addresses
};

constexpr RegisterTable register_table() {
    RegisterTable table;
    for (uint16_t address = 0; address < kIoStart; address++) { // the core's own registers
        table.implemented[address] = 0xFF;
    }
#define TILENCA_REGISTER(address, name, reset_value, known, exist, kept)                                     \
    table.reset[address] = reset_value;                                                                      \
    table.implemented[address] = exist;
#define TILENCA_PAIR(address, name, reset_value, known, exist, kept)                                         \
    table.reset[address] = (reset_value) & 0xFF;                                                             \
    table.reset[(address) + 1] = (reset_value) >> 8;                                                         \
    table.implemented[address] = (exist) & 0xFF;                                                             \
    table.implemented[(address) + 1] = (exist) >> 8;
#include "avr/registers.inc"
#undef TILENCA_REGISTER
#undef TILENCA_PAIR
    return table;
}

constexpr RegisterTable kRegisters = register_table();

} // namespace tilenca::avr
