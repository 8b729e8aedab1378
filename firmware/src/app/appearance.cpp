#include "app/appearance.h"

namespace tilenca {

namespace {

constexpr Look kFoundLook = {'8', 0x7F, 60, 60, 60};

// True for half of the time; changes about four times a second.
bool lit_phase(uint32_t now_ms) {
    return now_ms >> 8 & 1;
}

uint8_t scaled(uint8_t duty, uint8_t brightness) {
    return static_cast<uint8_t>(static_cast<uint16_t>(duty) * brightness / 255);
}

} // namespace

Appearance appearance_of(const Tile& tile, bool blinking, uint32_t now_ms) {
    Appearance appearance = {tile.shown(), 0};
    if (blinking) {
        appearance.shown = lit_phase(now_ms) ? Appearance::kFound : Tile::kNothing;
    }
    const uint8_t leds = tile.settings().leds;
    if (leds == kLedsMissing && tile.model().directions) {
        const uint8_t side = tile.missing();
        appearance.leds = side < kSides ? 1 << side : 0;
        return appearance;
    }
    for (uint8_t i = 0, mask = 1; i < kSides && leds != kLedsDark; ++i, mask <<= 1) {
        const Link& link = tile.link(side_at(i));
        if (link.alive() || (link.foreign() && lit_phase(now_ms))) {
            appearance.leds |= mask;
        }
    }
    return appearance;
}

Look look_of(const Tile& tile, uint8_t shown) {
    if (shown == Tile::kNothing) {
        return {};
    }
    Look look = shown == Appearance::kFound ? kFoundLook : tile.model().looks[shown];
    const uint8_t brightness = tile.settings().brightness;
    look.red = scaled(look.red, brightness);
    look.green = scaled(look.green, brightness);
    look.blue = scaled(look.blue, brightness);
    return look;
}

} // namespace tilenca
