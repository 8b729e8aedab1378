// What the tiles of a tissue are and have to live with. The C face of host/tilenca/simulator/rollout_library.py.
#pragma once

#include <stdint.h>

extern "C" {

enum TilencaFault : uint8_t { kNoFault, kDead, kStuck, kAway };

// All pointers stay the caller's and must live as long as the tissue. Cells of a run follow each other.
struct TilencaSetup {
    int32_t runs;
    int32_t cells;
    const int32_t* starts;     // [runs + 1], the first cell of each run, and the end
    const int32_t* neighbours; // [cells][4], N E S W; `cells` for none
    const uint8_t* alive;      // [cells], 0: never there
    const int8_t* target;      // [cells], the class that is right
    const uint64_t* seeds;     // [runs]
    uint64_t loss;             // of 2^32 messages so many are lost
    uint8_t zeros;             // a lost message reads as zeros; else the last one is held
    uint8_t clocks;            // every tile on its own clock; else the paper's sampler
    // On clocks, in 1/kUnits of a tick (schedule.h):
    int64_t start;          // when the first tile is switched on, a whole number of ticks, not above 0
    const int64_t* first;   // [cells], when each updates for the first time
    const int64_t* period;  // [cells]
    const int64_t* latency; // [cells], below the cell's period
    // One tile of a run has a fault: dead or away (silent and dark), or stuck (does not update, goes on
    // sending).
    TilencaFault fault;
    const int32_t* faulty; // [runs], a cell, or -1 for none
    int64_t begin;         // the first step of the fault; from 0 on it is there before all others start
    int64_t end;           // the step at which a tile that was away is back, in the seed state
};
}
