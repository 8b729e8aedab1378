#include "app/appearance.h"

namespace tilenca {

namespace {

constexpr Look kFound = {'8', 0xFF, 60, 60, 60};

// Half of the time, about twice a second.
bool lit_phase(uint32_t now_ms) {
    return now_ms >> 8 & 1;
}

} // namespace

Appearance appearance_of(const Tile& tile, bool blinking, uint32_t now_ms) {
    Appearance appearance = {};
    if (blinking) {
        appearance.look = lit_phase(now_ms) ? kFound : Look{};
    } else if (tile.shown() != Tile::kNothing) {
        appearance.look = tile.model().looks[tile.shown()];
    }
    for (uint8_t i = 0; i < kSides; ++i) {
        const Link& link = tile.link(side_at(i));
        if (link.alive() || (link.foreign() && lit_phase(now_ms))) {
            appearance.leds |= 1 << i;
        }
    }
    return appearance;
}

} // namespace tilenca
