#include "core/cell.h"

#include <string.h>

namespace tilenca {

namespace {

constexpr int16_t kSeedState = 1 << 13; // 1.0

} // namespace

Cell::Cell(const Network& network) : network_(network), forward_(network) {
    seed();
}

void Cell::seed() {
    forward_.stop();
    memset(state_, 0, sizeof state_);
    state_[0] = kSeedState;
    tell();
}

void Cell::perceive(const int8_t* const (&neighbours)[kSides]) {
    const uint8_t count = channels();
    for (uint8_t side = 0; side < kSides; ++side) {
        int8_t* tap = inputs_ + count * (1 + side);
        if (neighbours[side] == nullptr) {
            memset(tap, 0, count);
        } else {
            memcpy(tap, neighbours[side], count);
        }
    }
    forward_.begin(inputs_, state_);
}

bool Cell::update_slice() {
    if (!updating()) {
        return false;
    }
    forward_.step();
    if (updating()) {
        return false;
    }
    tell();
    return true;
}

uint8_t Cell::best_class(uint8_t classes) const {
    const int16_t* scores = state_ + channels() - classes;
    uint8_t best = 0;
    for (uint8_t k = 1; k < classes; ++k) {
        if (scores[k] > scores[best]) {
            best = k;
        }
    }
    return best;
}

void Cell::tell() {
    for (uint8_t c = 0; c < channels(); ++c) {
        inputs_[c] = message_of(state_[c]);
    }
}

} // namespace tilenca
