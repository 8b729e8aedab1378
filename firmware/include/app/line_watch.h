// Notices receiving lines that stay low. An idle line is high, and no byte is low for longer than nine bits;
// so a line that is low at every look for long has a short, or a neighbour without power.
#pragma once

#include <stdint.h>

#include "core/side.h"

namespace tilenca {

class LineWatch {
  public:
    // A shorter time may be bytes, at each of which the line was low by chance.
    static constexpr uint8_t kLeastLowMs = 50;

    // `low` has one bit per side, in the order N E S W. Call it in every turn of the main loop.
    void look(uint8_t low, uint32_t now_ms);

    // Milliseconds that the line stayed low, in stretches of at least kLeastLowMs.
    uint32_t low_ms(Side side) const { return low_ms_[index_of(side)]; }

  private:
    static constexpr uint8_t kAllSides = (1 << kSides) - 1;
    static constexpr uint8_t kWindowMs = 8; // spares the main loop work

    uint8_t always_low_ = kAllSides; // in the present window
    uint8_t began_ms_ = 0;           // when it began, modulo 256
    uint8_t run_ms_[kSides] = {};    // for how long the line has been low, up to kLeastLowMs
    uint32_t low_ms_[kSides] = {};
};

} // namespace tilenca
