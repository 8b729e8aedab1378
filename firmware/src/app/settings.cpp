#include "app/settings.h"

#include "core/crc16.h"

namespace tilenca {

namespace {

uint16_t word_at(const uint8_t* bytes) {
    return bytes[0] | static_cast<uint16_t>(bytes[1]) << 8;
}

} // namespace

bool parse_settings(const uint8_t (&block)[kSettingsSize], Settings* settings) {
    constexpr uint8_t kChecked = kSettingsSize - 2;
    if (block[0] != 'T' || block[1] != 'N' || block[2] != kSettingsVersion) {
        return false;
    }
    if (word_at(block + kChecked) != crc16(block, kChecked)) {
        return false;
    }
    const uint16_t period_ms = word_at(block + 4);
    if (period_ms < kMinPeriodMs || period_ms > kMaxPeriodMs) {
        return false;
    }
    *settings = {block[3], period_ms, word_at(block + 6)};
    return true;
}

} // namespace tilenca
