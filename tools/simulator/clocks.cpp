#include "clocks.h"

#include <limits.h>

#include <algorithm>

#include "core/link.h"

namespace tilenca {

namespace {

constexpr int32_t kNever = INT_MAX;

// The tick in which something happens.
int32_t tick_of(int64_t units) {
    return static_cast<int32_t>((units + kUnits - 1) >> kUnitBits);
}

} // namespace

Clocks::Clocks(const tilenca_setup& setup, int first, int last)
    : Schedule(setup, first, last, kTicks, tick_of(setup.start), kSilentPeriods * kTicks),
      period_(setup.period + setup.starts[first]), latency_(setup.latency + setup.starts[first] * kSides),
      seed_latency_(setup.seed_latency == nullptr ? latency_
                                                  : setup.seed_latency + setup.starts[first] * kSides),
      on_since_(on_.size(), INT64_MIN), next_(on_.size(), Next::Update), sent_at_(on_.size()),
      on_the_way_(on_.size()), sends_seed_(on_.size()), now_due_(on_.size()) {
    if (setup.line != nullptr) {
        std::copy_n(setup.line, kSides, line_);
    }
    const int64_t* updates = setup.first + setup.starts[first];
    for (int cell = 0; cell < cells(); ++cell) {
        next_update_.push_back(updates[cell]);
        due_.push_back(kNever);
        if (!on_[cell]) {
            continue;
        }
        int64_t begins = updates[cell];
        if (setup.running) {
            running_.push_back(cell);
        } else {
            begins -= period_[cell];
            next_[cell] = Next::Boot;
            on_[cell] = 0;
        }
        due_[cell] = std::max(tick_of(begins), now_ + 1);
    }
}

void Clocks::plan(Tick& tick) {
    int due = 0;
    // Without a branch, since this goes over all cells every tick.
    for (int cell = 0; cell < cells(); ++cell) {
        now_due_[due] = cell;
        due += due_[cell] == now_;
    }
    for (int32_t cell : running_) {
        if (on_[cell]) {
            tick.deliveries.push_back({cell, links_.send(cell, kAllSides, random_of(cell), now_)});
        }
    }
    running_.clear();
    for (int i = 0; i < due; ++i) {
        const int cell = now_due_[i];
        if (next_[cell] == Next::Boot) {
            on_[cell] = 1;
            tick.switched_on.push_back(cell);
            boot(cell, next_update_[cell] - period_[cell]);
        }
    }
    for (int i = 0; i < due; ++i) {
        const int cell = now_due_[i];
        if (next_[cell] == Next::Arrival && due_[cell] == now_) {
            send(cell, tick);
        }
    }
    for (int i = 0; i < due; ++i) {
        if (due_[now_due_[i]] == now_) {
            update(now_due_[i], tick);
        }
    }
}

void Clocks::update(int cell, Tick& tick) {
    if (!stuck_[cell]) {
        tick.updates.push_back({cell, links_.absent(cell, random_of(cell), now_)});
    }
    sent_at_[cell] = next_update_[cell];
    sends_seed_[cell] = 0;
    next_update_[cell] += period_[cell];
    on_the_way_[cell] = kAllSides;
    await_arrival(cell);
}

// The cell's message arrives where it is due now. Then the next arrival or update is awaited.
void Clocks::send(int cell, Tick& tick) {
    Sides heard = 0;
    for (int side = 0; side < kSides; ++side) {
        const auto bit = static_cast<Sides>(1 << side);
        if ((on_the_way_[cell] & bit) && tick_of(arrival(cell, side)) <= now_) {
            on_the_way_[cell] &= static_cast<Sides>(~bit);
            heard |= deaf(cell, side) ? 0 : bit;
        }
    }
    tick.deliveries.push_back({cell, links_.send(cell, heard, random_of(cell), now_)});
    await_arrival(cell);
}

// When the message that is on its way arrives at a side, in units.
int64_t Clocks::arrival(int cell, int side) const {
    const int64_t* latency = sends_seed_[cell] ? seed_latency_ : latency_;
    return sent_at_[cell] + latency[cell * kSides + side];
}

// Whether the neighbour on that side was switched on while the message was on its line.
bool Clocks::deaf(int cell, int side) const {
    const int other = links_.neighbour(cell, side);
    return line_[side] > 0 && other >= 0 && arrival(cell, side) - line_[side] < on_since_[other];
}

void Clocks::await_arrival(int cell) {
    int64_t next = INT64_MAX;
    for (int side = 0; side < kSides; ++side) {
        if (on_the_way_[cell] >> side & 1) {
            next = std::min(next, arrival(cell, side));
        }
    }
    const bool arrives = on_the_way_[cell] != 0;
    next_[cell] = arrives ? Next::Arrival : Next::Update;
    due_[cell] = arrives ? std::max(tick_of(next), now_ + 1) : std::max(tick_of(next_update_[cell]), now_);
}

void Clocks::switch_off(int cell) {
    due_[cell] = kNever;
}

void Clocks::switch_on(int cell) {
    boot(cell, now_ * kUnits);
}

// Switched on at a time, in units: its seed state is on its way, and its first update is one period later.
void Clocks::boot(int cell, int64_t at) {
    on_since_[cell] = at;
    sent_at_[cell] = at;
    sends_seed_[cell] = 1;
    next_update_[cell] = at + period_[cell];
    on_the_way_[cell] = kAllSides;
    await_arrival(cell);
}

} // namespace tilenca
