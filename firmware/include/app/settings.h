// What a tile can be told once and keeps in EEPROM: docs/PROTOCOL.md section 5. Pure bytes, no EEPROM here.
#pragma once

#include <stdint.h>

#include "core/link.h" // kMaxPeriodMs

namespace tilenca {

constexpr uint8_t kSettingsSize = 12;
constexpr uint8_t kSettingsVersion = 2;
constexpr uint16_t kMinPeriodMs = 10;

struct Settings {
    uint8_t tile_id;    // 0: not set
    uint16_t period_ms; // from update to update
    uint16_t updates;   // then stop; 0: for ever
    uint8_t brightness; // of digit and colour, of 255
};

// Reads a block as it lies in EEPROM. False, and `settings` as it was, if anything about it is not right.
bool parse_settings(const uint8_t (&block)[kSettingsSize], Settings* settings);

// Writes the block that parse_settings() reads.
void write_settings(const Settings& settings, uint8_t (&block)[kSettingsSize]);

// Whether nobody has ever written there: then the defaults are no error.
bool is_blank(const uint8_t (&block)[kSettingsSize]);

} // namespace tilenca
