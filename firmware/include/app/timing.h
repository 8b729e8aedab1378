// Where a tile's time goes, from one report to the next. Microseconds come in as numbers.
#pragma once

#include <stdint.h>

namespace tilenca {

class Timing {
  public:
    // Call it at the beginning of every turn of the main loop.
    void turn(uint32_t now_us) {
        const uint32_t gap_us = now_us - turn_us_;
        if (started_ && gap_us > gap_us_) {
            gap_us_ = gap_us;
        }
        if (!started_) {
            reported_us_ = now_us;
        }
        started_ = true;
        turn_us_ = now_us;
    }

    // Of a slice of an update; `ended`: it was the last one.
    void computed(uint32_t us, bool ended) {
        update_us_ += us;
        if (ended) {
            compute_us_ = update_us_ > compute_us_ ? update_us_ : compute_us_;
            update_us_ = 0;
        }
    }

    void slept(uint32_t us) { slept_us_ += us; }

    // Since the last reported(): the longest update and turn, and the share of time not asleep.
    uint32_t compute_us() const { return compute_us_; }
    uint32_t gap_us() const { return gap_us_; }
    uint16_t awake_permille() const {
        const uint32_t passed_ms = (turn_us_ - reported_us_) / 1000;
        const uint32_t asleep = passed_ms == 0 ? 0 : slept_us_ / passed_ms;
        return asleep > 1000 ? 0 : static_cast<uint16_t>(1000 - asleep);
    }

    // Begins anew.
    void reported() {
        compute_us_ = gap_us_ = slept_us_ = 0;
        reported_us_ = turn_us_;
    }

  private:
    uint32_t turn_us_ = 0;
    uint32_t reported_us_ = 0;
    uint32_t update_us_ = 0; // of the update under way
    uint32_t compute_us_ = 0;
    uint32_t gap_us_ = 0;
    uint32_t slept_us_ = 0;
    bool started_ = false;
};

} // namespace tilenca
