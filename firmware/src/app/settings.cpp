#include "app/settings.h"

#include "core/crc16.h"

#ifdef __AVR__
#pragma GCC optimize("Os") // it runs once in a while, and flash is short
#endif

namespace tilenca {

namespace {

uint16_t word_at(const uint8_t* bytes) {
    return bytes[0] | static_cast<uint16_t>(bytes[1]) << 8;
}

void put_word(uint16_t word, uint8_t* bytes) {
    bytes[0] = static_cast<uint8_t>(word);
    bytes[1] = static_cast<uint8_t>(word >> 8);
}

char letter_of(Block kind) {
    return kind == Block::Marking ? 'B' : 'N';
}

constexpr uint8_t kChecked = kSettingsSize - 2;

} // namespace

bool parse_settings(Block kind, const uint8_t (&block)[kSettingsSize], Settings* settings) {
    if (block[0] != 'T' || block[1] != letter_of(kind) || block[2] != kSettingsVersion ||
        block[9] > kLedsMissing) {
        return false;
    }
    if (word_at(block + kChecked) != crc16(block, kChecked)) {
        return false;
    }
    if (kind == Block::Marking) {
        settings->revision = block[3];
        settings->serial = word_at(block + 4);
        return true;
    }
    const uint16_t period_ms = word_at(block + 4);
    if (period_ms < kMinPeriodMs || period_ms > kMaxPeriodMs) {
        return false;
    }
    settings->tile_id = block[3];
    settings->period_ms = period_ms;
    settings->updates = word_at(block + 6);
    settings->brightness = block[8];
    settings->leds = block[9];
    return true;
}

void write_settings(Block kind, const Settings& settings, uint8_t (&block)[kSettingsSize]) {
    const bool marking = kind == Block::Marking;
    block[0] = 'T';
    block[1] = letter_of(kind);
    block[2] = kSettingsVersion;
    block[3] = marking ? settings.revision : settings.tile_id;
    put_word(marking ? settings.serial : settings.period_ms, block + 4);
    put_word(marking ? 0 : settings.updates, block + 6);
    block[8] = marking ? 0 : settings.brightness;
    block[9] = marking ? 0 : settings.leds;
    put_word(crc16(block, kChecked), block + kChecked);
}

bool is_blank(const uint8_t (&block)[kSettingsSize]) {
    for (uint8_t byte : block) {
        if (byte != 0xFF) {
            return false;
        }
    }
    return true;
}

} // namespace tilenca
