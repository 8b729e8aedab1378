#include "core/cell.h"

#include <string.h>

namespace tilenca {

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
        int8_t* message = inputs_ + count * (1 + side);
        if (neighbours[side] == nullptr) {
            memset(message, 0, count);
        } else {
            memcpy(message, neighbours[side], count);
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

Decision Cell::decide(uint8_t classes) const {
    return tilenca::decide(state_ + channels() - classes, classes);
}

void Cell::tell() {
    for (uint8_t c = 0; c < channels(); ++c) {
        inputs_[c] = message_of(state_[c]);
    }
}

} // namespace tilenca
