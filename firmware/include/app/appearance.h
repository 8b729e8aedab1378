// What a person is to see of a tile: digit and colour, and one debug LED per side.
#pragma once

#include <stdint.h>

#include "app/tile.h"

namespace tilenca {

struct Appearance {
    Look look;    // dark while nothing is shown
    uint8_t leds; // one bit per side, in the order N E S W
};

// A side's LED is lit while its neighbour is alive and blinks while it runs another model. `blinking`: all
// segments and white blink instead of the class, as no shape does.
Appearance appearance_of(const Tile& tile, bool blinking, uint32_t now_ms);

// A colour's duty at a brightness, both of 255.
inline uint8_t scaled(uint8_t duty, uint8_t brightness) {
    return static_cast<uint8_t>(static_cast<uint16_t>(duty) * brightness / 255);
}

} // namespace tilenca
