#include "schedule.h"

#include "clocks.h"
#include "core/link.h"
#include "sampler.h"

namespace tilenca {

Schedule::Schedule(const tilenca_setup& setup, int first, int last, int ticks, int start)
    : now_(start), links_(setup, first, last, kSilentPeriods * ticks), setup_(setup), first_(first),
      last_(last), ticks_(ticks) {
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
}

bool Schedule::next(Tick& tick) {
    tick.switched_off.clear();
    tick.switched_on.clear();
    tick.deliveries.clear();
    tick.updates.clear();
    if (now_ >= 0 && now_ % ticks_ == 0 && setup_.fault != TILENCA_FAULT_NONE) {
        begin_step(tick, now_ / ticks_);
    }
    ++now_;
    plan(tick);
    return now_ > 0 && now_ % ticks_ == 0;
}

void Schedule::begin_step(Tick& tick, int64_t step) {
    const bool back = setup_.fault == TILENCA_FAULT_AWAY && step == setup_.end;
    if (!back && (step != setup_.begin || step == 0)) {
        return;
    }
    for (int run = first_; run < last_; ++run) {
        const int cell = setup_.faulty[run] - setup_.starts[first_];
        if (setup_.faulty[run] < 0 || !setup_.alive[setup_.faulty[run]]) {
            continue;
        }
        if (back) {
            on_[cell] = 1;
            switch_on(cell);
            tick.switched_on.push_back(cell);
        } else if (setup_.fault == TILENCA_FAULT_STUCK) {
            stuck_[cell] = 1;
        } else {
            on_[cell] = 0;
            switch_off(cell);
            tick.switched_off.push_back(cell);
        }
    }
}

std::unique_ptr<Schedule> make_schedule(const tilenca_setup& setup, int first, int last) {
    if (setup.clocks) {
        return std::make_unique<Clocks>(setup, first, last);
    }
    return std::make_unique<Sampler>(setup, first, last);
}

} // namespace tilenca
