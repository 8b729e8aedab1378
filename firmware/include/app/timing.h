// How a tile spends its time, from one report to the next.
//
// Short times are differences of stamps, which are half microseconds modulo 2^16 and cheap to read.
#pragma once

#include <stdint.h>

namespace tilenca {

class Timing {
  public:
    // Call it at the beginning of every turn of the main loop.
    void turn(uint32_t now_ms, uint16_t stamp) {
        const uint32_t passed_ms = now_ms - turn_ms_;
        const uint32_t halves =
            passed_ms < kStampWrapsMs ? static_cast<uint16_t>(stamp - turn_stamp_) : passed_ms * kHalvesPerMs;
        turn_ms_ = now_ms;
        turn_stamp_ = stamp;
        if (started_) {
            gap_ = halves > gap_ ? halves : gap_;
        } else {
            started_ = true;
            reported();
        }
    }

    // Adds the time of a slice of an update; `last`: this completed the update.
    void computed(uint16_t halves, bool last) {
        update_ += halves;
        if (last) {
            compute_ = update_ > compute_ ? update_ : compute_;
            update_ = 0;
        }
    }

    void slept(uint16_t halves) { slept_ += halves; }

    // Since the last reported(): the longest update, the longest turn, and the share of time awake.
    uint32_t compute_us() const { return compute_ / 2; }
    uint32_t gap_us() const { return gap_ / 2; }
    uint16_t awake_permille() const {
        const uint32_t passed_ms = turn_ms_ - reported_ms_;
        const uint32_t asleep = passed_ms == 0 ? 0 : slept_ / 2 / passed_ms;
        return asleep > 1000 ? 0 : static_cast<uint16_t>(1000 - asleep);
    }

    // Starts the measurements anew.
    void reported() {
        compute_ = gap_ = slept_ = 0;
        reported_ms_ = turn_ms_;
    }

  private:
    static constexpr uint16_t kHalvesPerMs = 2000;
    static constexpr uint8_t kStampWrapsMs = 0xFFFF / kHalvesPerMs;

    uint32_t turn_ms_ = 0;
    uint32_t reported_ms_ = 0;
    uint32_t update_ = 0; // of the update under way
    uint32_t compute_ = 0;
    uint32_t gap_ = 0;
    uint32_t slept_ = 0;
    uint16_t turn_stamp_ = 0;
    bool started_ = false;
};

} // namespace tilenca
