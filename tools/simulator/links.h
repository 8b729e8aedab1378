// Which messages arrive, and which neighbours are silent. Cells count from 0 within a group of runs.
#pragma once

#include <stdint.h>

#include <vector>

#include "core/side.h"
#include "random.h"
#include "tilenca/simulator.h"

namespace tilenca {

using Sides = uint8_t; // bit s: side s
constexpr Sides kAllSides = 0xF;

class Links {
  public:
    // Of the runs [first, last) of the setup. A side is silent when nothing came for `silent_after`.
    // Times are in a unit of the caller's, ticks or steps.
    Links(const tilenca_setup& setup, int first, int last, int silent_after);

    // -1 for none.
    int neighbour(int cell, int side) const { return neighbours_[cell * kSides + side]; }

    // Sends the cell's message to some sides; those on which it arrives.
    Sides send(int cell, Sides sides, Random& random, int now);

    // The cell would send again what it sent last: sides where its message arrived a unit of time ago are not
    // silent now.
    void renew(int cell, int now);

    // The sides whose message the cell reads as zeros.
    Sides absent(int cell, Random& random, int now) const;

    // Whether renew() does anything.
    bool tracks_silence() const { return tracks_silence_; }

  private:
    Sides lost(Random& random) const;

    std::vector<int32_t> neighbours_;
    std::vector<int32_t> arrived_; // [cell][side], when the cell's message last arrived there
    uint64_t loss_;
    bool zeros_;
    bool tracks_silence_;
    int silent_after_;
};

} // namespace tilenca
