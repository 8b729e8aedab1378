// The chip's fuse and lock bytes, as the program reads them (data sheet, reading the fuse and lock bits from
// software).
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

struct Fuses {
    uint8_t low, high, extended, lock;
};

// Not while EEPROM is being written.
Fuses fuses();

} // namespace board
} // namespace tilenca
