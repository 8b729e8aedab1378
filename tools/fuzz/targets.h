// What is fuzzed: each takes any bytes, and must neither misbehave nor break what it promises.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace tilenca {
namespace fuzz {

using Target = void (*)(const uint8_t* bytes, size_t size);

// Bytes of a line, to a link of a tile.
void frames(const uint8_t* bytes, size_t size);

// Bytes of the host, to a tile with its EEPROM.
void commands(const uint8_t* bytes, size_t size);

// An EEPROM, which a tile starts with; the first byte says where the power fails.
void settings(const uint8_t* bytes, size_t size);

// The target of a name; nullptr: there is none.
Target target_of(const char* name);

} // namespace fuzz
} // namespace tilenca
