// Updates of many cells by the firmware's arithmetic, as many at once as the processor's vectors are wide.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "packed.h"

namespace tilenca {

// One update. Both pointers stay the caller's.
struct CellUpdate {
    const int8_t* inputs; // 5 C messages: own, then those of N, E, S, W
    int16_t* state;       // C stored values, changed in place
    uint8_t absent;       // bit s: the message of side s reads as zeros
};

constexpr int kWidest = 0;

// Every state to the bit as the chip's, whatever the number of cells side by side; false if this machine
// cannot do so many. No two updates are of the same cell.
bool update_cells(const PackedNetwork& network, const CellUpdate* updates, size_t count, int lanes = kWidest);

} // namespace tilenca
