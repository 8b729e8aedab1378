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
    uint8_t leds;       // what the link LEDs show

    // The marking: what board this is. It has a block of its own, and no preset changes it.
    uint8_t revision = 0; // 0: not marked
    uint16_t serial = 0;
};

// Of the link LEDs, as EEPROM has it. The command counts otherwise: 0 is dark, 1 links, 2 what is missing.
constexpr uint8_t kLedsLinks = 0; // which neighbours are alive
constexpr uint8_t kLedsDark = 1;
constexpr uint8_t kLedsMissing = 2; // on which side a tile is missing

// The kinds of blocks. Each is kept twice, one kind after the other.
enum class Block : uint8_t { Settings, Marking };
constexpr uint8_t kBlocks = 2;

// Reads a block of one kind from EEPROM, and leaves the rest of `settings` unchanged. If anything in it is
// wrong, returns false and leaves all of it unchanged.
bool parse_settings(Block kind, const uint8_t (&block)[kSettingsSize], Settings* settings);

// Writes the block that parse_settings() reads.
void write_settings(Block kind, const Settings& settings, uint8_t (&block)[kSettingsSize]);

// Whether the block was never written. Then the defaults hold without an error.
bool is_blank(const uint8_t (&block)[kSettingsSize]);

} // namespace tilenca
