// What a person sees of a tile: digit and colour, and one debug LED per side.
#pragma once

#include <stdint.h>

#include "app/tile.h"

namespace tilenca {

struct Appearance {
    uint8_t shown; // a class, kFound, or Tile::kNothing, which is dark
    uint8_t leds;  // one bit per side, in the order N E S W

    static constexpr uint8_t kFound = 0xFE;
};

// A side's LED is lit while its neighbour is alive, and blinks while the neighbour runs another model; or, by
// a setting, it is lit while the tile says that one is missing there. With `blinking`, a white 8 blinks
// instead of the class.
Appearance appearance_of(const Tile& tile, bool blinking, uint32_t now_ms);

// The look of `shown` at the tile's brightness.
Look look_of(const Tile& tile, uint8_t shown);

} // namespace tilenca
