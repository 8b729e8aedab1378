// A few bytes at the beginning of EEPROM. Writing takes 3.4 ms a byte, during which the tile goes on.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Copies bytes from address 0; not while eeprom_writing().
void eeprom_read(uint8_t* bytes, uint8_t size);

// Begins to write bytes to address 0; they must live until that is done.
void eeprom_write(const uint8_t* bytes, uint8_t size);

// Goes on writing if the chip is ready for it, without waiting; false when all is done.
bool eeprom_writing();

} // namespace board
} // namespace tilenca
