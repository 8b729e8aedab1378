// A few bytes at the beginning of EEPROM, kept twice. Writing takes 3.4 ms a byte, during which the tile goes
// on; whenever the power fails, one of both is whole.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

enum class Kept : uint8_t { First, Second };

// Copies the bytes from address 0, or the second ones, which lie behind the first; not while
// eeprom_writing().
void eeprom_read(Kept which, uint8_t* bytes, uint8_t size);

// Begins to write bytes, the second ones first; they must live until that is done.
void eeprom_write(const uint8_t* bytes, uint8_t size);

// Goes on writing if the chip is ready for it, without waiting; false when all is done. True at first if a
// reset came while a byte was being written, which it does not stop.
bool eeprom_writing();

} // namespace board
} // namespace tilenca
