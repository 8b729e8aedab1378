// The first 256 bytes of EEPROM, as app/settings_store.h wants them. A byte takes 3.4 ms to write, during
// which the program goes on. A reset does not stop it.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

struct Eeprom {
    static bool busy();
    static uint8_t read(uint8_t address);
    static void write(uint8_t address, uint8_t byte);
};

} // namespace board
} // namespace tilenca
