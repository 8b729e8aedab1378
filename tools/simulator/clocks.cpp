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
      period_(setup.period + setup.starts[first]), latency_(setup.latency + setup.starts[first]),
      next_(on_.size(), Next::Update), now_due_(on_.size()) {
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
            tick.deliveries.push_back({cell, links_.send(cell, random_of(cell), now_)});
        }
    }
    running_.clear();
    for (int i = 0; i < due; ++i) {
        const int cell = now_due_[i];
        if (next_[cell] == Next::Boot) {
            on_[cell] = 1;
            tick.switched_on.push_back(cell);
            boot(cell, next_update_[cell] - period_[cell]);
        } else if (next_[cell] == Next::Arrival) {
            tick.deliveries.push_back({cell, links_.send(cell, random_of(cell), now_)});
            next_[cell] = Next::Update;
            due_[cell] = std::max(tick_of(next_update_[cell]), now_);
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
    next_[cell] = Next::Arrival;
    due_[cell] = std::max(tick_of(next_update_[cell] + latency_[cell]), now_ + 1);
    next_update_[cell] += period_[cell];
}

void Clocks::switch_off(int cell) {
    due_[cell] = kNever;
}

void Clocks::switch_on(int cell) {
    boot(cell, now_ * kUnits);
}

// Switched on at a time, in units: its seed state is on its way, and its first update is one period later.
void Clocks::boot(int cell, int64_t at) {
    next_[cell] = Next::Arrival;
    due_[cell] = std::max(tick_of(at + latency_[cell]), now_ + 1);
    next_update_[cell] = at + period_[cell];
}

} // namespace tilenca
