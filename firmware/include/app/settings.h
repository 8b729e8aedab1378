// The settings that a tile keeps in EEPROM, and the bytes that they are there: docs/PROTOCOL.md section 5.
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
    uint16_t updates;   // after these the tile stops; 0: never
    uint8_t brightness; // of digit, colour and link LEDs, of 255
    uint8_t leds_off;   // 1: the link LEDs stay dark
};

// Reads a block from EEPROM. If anything in it is wrong, returns false and leaves `settings` unchanged.
bool parse_settings(const uint8_t (&block)[kSettingsSize], Settings* settings);

// Writes the block that parse_settings() reads.
void write_settings(const Settings& settings, uint8_t (&block)[kSettingsSize]);

// Whether the block was never written. Then the defaults hold without an error.
bool is_blank(const uint8_t (&block)[kSettingsSize]);

} // namespace tilenca
