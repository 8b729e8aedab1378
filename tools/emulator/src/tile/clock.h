// Time: each tile counts its own cycles; the array counts ticks of an exact 16 MHz since it began.
#pragma once

#include <cmath>
#include <cstdint>

namespace tilenca {

constexpr double kTicksPerSecond = 16e6;

struct Clock {
    double rate = 1;      // cycles per tick: 1 + error
    double switch_on = 0; // tick of cycle 0

    double to_ticks(uint64_t cycle) const { return switch_on + static_cast<double>(cycle) / rate; }
    // The first cycle at or after that time; 0 before the tile is switched on.
    uint64_t to_cycle(double ticks) const {
        const double cycles = std::ceil((ticks - switch_on) * rate);
        return cycles <= 0 ? 0 : static_cast<uint64_t>(cycles);
    }
};

} // namespace tilenca
