// Registers that only store what is written to them, and when a program should be told so.
#pragma once

#include <cstdint>

namespace tilenca::avr {

// The name of the missing function that writing `value` to `address` asks for; null: none, storing is enough.
const char* unmodelled_function(uint16_t address, uint8_t value);

// Whether writes to the address have to be looked at at all.
bool is_unmodelled(uint16_t address);

} // namespace tilenca::avr
