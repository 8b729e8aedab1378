// The supply voltage: the ADC measures the bandgap's 1.1 V against it.
//
// The bandgap of a chip is 1.0 to 1.2 V, so the voltage of a tile may be wrong by 9 %, always by the same
// share (data sheet, system and reset characteristics).
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// Turns the ADC on.
void supply_begin();

// Takes a conversion that is ready, and begins the next. Call it in every turn of the main loop.
void supply_watch();

// In mV, the mean of 64 conversions; 0: not known yet.
uint16_t supply_mv();

} // namespace board
} // namespace tilenca
