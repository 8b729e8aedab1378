#include "schedule.h"

#include "clocks.h"
#include "halves.h"
#include "listing.h"

namespace tilenca {

Schedule::Schedule(const tilenca_setup& setup, int first, int last, int ticks, int start, int silent_after)
    : now_(start), links_(setup, first, last, silent_after), setup_(setup), first_(first), last_(last),
      ticks_(ticks) {
    const int32_t begin = setup.starts[first], end = setup.starts[last];
    on_.assign(setup.alive + begin, setup.alive + end);
    counts_ = on_;
    stuck_.assign(on_.size(), 0);
    for (int run = first; run < last; ++run) {
        random_.emplace_back(setup.seeds[run]);
        starts_.push_back(setup.starts[run] - begin);
        run_.insert(run_.end(), setup.starts[run + 1] - setup.starts[run], run - first);
        if (setup.fault == TILENCA_FAULT_NONE || setup.faulty[run] < 0) {
            continue;
        }
        const int cell = setup.faulty[run] - begin;
        counts_[cell] &= setup.fault == TILENCA_FAULT_AWAY; // it comes back, and must be right then
        if (setup.begin == 0) {
            (setup.fault == TILENCA_FAULT_STUCK ? stuck_ : on_)[cell] = setup.fault == TILENCA_FAULT_STUCK;
        }
    }
    starts_.push_back(end - begin);
    for (int32_t i = 0; i < setup.changes_count; ++i) {
        const tilenca_change& change = setup.changes[i];
        if (change.cell >= begin && change.cell < end) {
            changes_.push_back({change.step, change.cell - begin, change.on});
        }
    }
}

bool Schedule::next(Tick& tick) {
    tick.switched_off.clear();
    tick.switched_on.clear();
    tick.deliveries.clear();
    tick.updates.clear();
    tick.put_down.clear();
    tick.taken_away.clear();
    if (now_ >= 0 && now_ % ticks_ == 0) {
        if (setup_.fault != TILENCA_FAULT_NONE) {
            begin_fault(tick, now_ / ticks_);
        }
        change(tick, now_ / ticks_);
    }
    ++now_;
    plan(tick);
    return now_ > 0 && now_ % ticks_ == 0;
}

void Schedule::begin_fault(Tick& tick, int64_t step) {
    const bool back = setup_.fault == TILENCA_FAULT_AWAY && step == setup_.end;
    if (!back && (step != setup_.begin || step == 0)) {
        return;
    }
    for (int run = first_; run < last_; ++run) {
        const int cell = setup_.faulty[run] - setup_.starts[first_];
        if (setup_.faulty[run] < 0 || !setup_.alive[setup_.faulty[run]]) {
            continue;
        }
        if (!back && setup_.fault == TILENCA_FAULT_STUCK) {
            stuck_[cell] = 1;
        } else {
            power(cell, back, tick);
        }
    }
}

void Schedule::change(Tick& tick, int64_t step) {
    for (; next_change_ < changes_.size() && changes_[next_change_].step <= step; ++next_change_) {
        const int cell = changes_[next_change_].cell;
        const bool on = changes_[next_change_].on != 0;
        if (on_[cell] == on) {
            continue;
        }
        power(cell, on, tick);
        counts_[cell] = on;
        (on ? tick.put_down : tick.taken_away).push_back(cell);
    }
}

void Schedule::power(int cell, bool on, Tick& tick) {
    on_[cell] = on;
    if (on) {
        switch_on(cell);
        tick.switched_on.push_back(cell);
    } else {
        switch_off(cell);
        tick.switched_off.push_back(cell);
    }
}

std::unique_ptr<Schedule> make_schedule(const tilenca_setup& setup, int first, int last) {
    switch (setup.schedule) {
    case TILENCA_SCHEDULE_CLOCKS:
        return std::make_unique<Clocks>(setup, first, last);
    case TILENCA_SCHEDULE_LISTING:
        return std::make_unique<Listing>(setup, first, last);
    default:
        return std::make_unique<Halves>(setup, first, last);
    }
}

} // namespace tilenca
