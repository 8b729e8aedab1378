#include "listing.h"

#include <algorithm>

#include "core/link.h"

namespace tilenca {

namespace {

// One tick for each cell of the largest run, and one that delivers the last message.
int ticks_of(const tilenca_setup& setup, int first, int last) {
    int most = 0;
    for (int run = first; run < last; ++run) {
        most = std::max(most, setup.starts[run + 1] - setup.starts[run]);
    }
    return most + 1;
}

} // namespace

Listing::Listing(const tilenca_setup& setup, int first, int last)
    : Schedule(setup, first, last, ticks_of(setup, first, last), 0, kSilentPeriods) {
    for (int cell = 0; cell < cells(); ++cell) {
        if (on_[cell]) {
            sending_.push_back(cell); // every cell's state is known to its neighbours
        }
    }
}

void Listing::plan(Tick& tick) {
    const int turn = (now_ - 1) % ticks(), step = (now_ - 1) / ticks();
    if (turn == 0 && links_.tracks_silence()) {
        // A cell that is not drawn is not silent: its last message still is its state.
        for (int cell = 0; cell < cells(); ++cell) {
            if (on_[cell]) {
                links_.renew(cell, step);
            }
        }
    }
    for (int32_t cell : sending_) {
        tick.deliveries.push_back({cell, links_.send(cell, kAllSides, random_of(cell), step)});
    }
    sending_.clear();
    for (size_t run = 0; run < random_.size(); ++run) {
        if (turn < starts_[run + 1] - starts_[run]) {
            draw(run, step, tick);
        }
    }
}

void Listing::draw(size_t run, int step, Tick& tick) {
    Random& random = random_[run];
    const uint64_t cells = starts_[run + 1] - starts_[run];
    const int cell = starts_[run] + static_cast<int>((random.next() >> 32) * cells >> 32);
    if (!on_[cell]) {
        return;
    }
    sending_.push_back(cell);
    if (!stuck_[cell]) {
        tick.updates.push_back({cell, links_.absent(cell, random, step)});
    }
}

} // namespace tilenca
