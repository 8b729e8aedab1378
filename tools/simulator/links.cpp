#include "links.h"

#include <limits.h>

namespace tilenca {

namespace {

constexpr int32_t kNever = INT_MIN / 2; // long before any tick, and a difference to it still fits

constexpr int opposite_of(int side) {
    return index_of(opposite(side_at(static_cast<uint8_t>(side))));
}

} // namespace

Links::Links(const tilenca_setup& setup, int first, int last, int silent_after)
    : loss_(setup.loss), zeros_(setup.zeros != 0),
      tracks_silence_(setup.fault != TILENCA_FAULT_NONE || setup.changes_count > 0 ||
                      (setup.loss > 0 && setup.zeros == 0)),
      silent_after_(silent_after) {
    const int32_t begin = setup.starts[first], end = setup.starts[last];
    for (int32_t i = begin * kSides; i < end * kSides; ++i) {
        neighbours_.push_back(setup.neighbours[i] < setup.cells ? setup.neighbours[i] - begin : -1);
    }
    arrived_.assign(tracks_silence_ ? neighbours_.size() : 0, kNever);
}

// Draws two numbers.
Sides Links::lost(Random& random) const {
    Sides sides = 0;
    for (int pair = 0; pair < kSides; pair += 2) {
        const uint64_t draw = random.next();
        sides |= static_cast<Sides>((static_cast<uint32_t>(draw) < loss_) << pair);
        sides |= static_cast<Sides>(((draw >> 32) < loss_) << (pair + 1));
    }
    return sides;
}

Sides Links::send(int cell, Sides sides, Random& random, int now) {
    const Sides told = sides;
    if (loss_ > 0 && !zeros_) {
        sides &= static_cast<Sides>(~lost(random));
    }
    for (int side = 0; side < kSides; ++side) {
        if (neighbour(cell, side) < 0) {
            sides &= static_cast<Sides>(~(1 << side));
        } else if (tracks_silence_ && (told >> side & 1)) {
            int32_t& arrived = arrived_[cell * kSides + side];
            // What is lost takes back what renew() said: the message that arrived is no longer the last one.
            arrived = sides >> side & 1 ? now : arrived - (arrived == now);
        }
    }
    return sides;
}

void Links::renew(int cell, int now) {
    for (int32_t* arrived = &arrived_[cell * kSides]; arrived < &arrived_[cell * kSides] + kSides;
         ++arrived) {
        *arrived += *arrived == now - 1;
    }
}

Sides Links::absent(int cell, Random& random, int now) const {
    Sides sides = loss_ > 0 && zeros_ ? lost(random) : 0;
    for (int side = 0; tracks_silence_ && side < kSides; ++side) {
        const int other = neighbour(cell, side);
        if (other >= 0 && now - arrived_[other * kSides + opposite_of(side)] > silent_after_) {
            sides |= static_cast<Sides>(1 << side);
        }
    }
    return sides;
}

} // namespace tilenca
