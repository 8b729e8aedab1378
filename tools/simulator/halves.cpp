#include "halves.h"

#include <algorithm>

#include "core/link.h"

namespace tilenca {

namespace {

constexpr int kHalves = 2; // ticks of a step

} // namespace

Halves::Halves(const tilenca_setup& setup, int first, int last)
    : Schedule(setup, first, last, kHalves, 0, kSilentPeriods * kHalves), sent_(on_.size()) {
    for (int cell = 0; cell < cells(); ++cell) {
        if (on_[cell]) {
            sending_.push_back(cell); // every cell sends what it starts from
        }
    }
}

void Halves::plan(Tick& tick) {
    deliver(tick);
    sending_.clear();
    for (size_t run = 0; run < random_.size(); ++run) {
        Random& random = random_[run];
        for (int from = starts_[run]; from < starts_[run + 1]; from += 64) {
            const int to = std::min(from + 64, starts_[run + 1]);
            uint64_t fires = random.next();
            for (int cell = from; cell < to; ++cell, fires >>= 1) {
                if (!(fires & 1) || !on_[cell]) {
                    continue;
                }
                sending_.push_back(cell);
                if (!stuck_[cell]) {
                    tick.updates.push_back({cell, links_.absent(cell, random, now_)});
                }
            }
        }
    }
}

void Halves::deliver(Tick& tick) {
    if (links_.tracks_silence()) {
        // A cell that skips its turn is not silent: its last message still is its state.
        std::fill(sent_.begin(), sent_.end(), 0);
        for (int32_t cell : sending_) {
            sent_[cell] = 1;
        }
        for (int cell = 0; cell < cells(); ++cell) {
            if (on_[cell] && !sent_[cell]) {
                links_.renew(cell, now_);
            }
        }
    }
    for (int32_t cell : sending_) {
        if (on_[cell]) {
            tick.deliveries.push_back({cell, links_.send(cell, kAllSides, random_of(cell), now_)});
        }
    }
}

} // namespace tilenca
