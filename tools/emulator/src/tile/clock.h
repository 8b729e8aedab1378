// Time: each tile counts its own cycles; the array counts ticks of an exact 16 MHz since it began.
#pragma once

#include "avr/archive.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tilenca {

constexpr double kTicksPerSecond = 16e6;
// A drifting clock changes its rate in steps, at multiples of this.
constexpr double kDriftTicks = 1 << 20;
// How wrong a clock can be but for its skew, also one that has drifted for long; at -1 it would stand still.
constexpr double kMostError = 0.5;
// Cycles of a chip at the end of a turn: one that was halted in it is behind. One that starts is ahead.
constexpr double kMostBehind = 1 << 14;

class Clock {
  public:
    // error: how much faster than nominal; drift: by how much more after each second; tick of cycle 0.
    explicit Clock(double error = 0, double drift = 0, double switch_on = 0)
        : error_(error), drift_(drift), anchor_ticks_(switch_on), rate_(1 + error) {}

    double to_ticks(uint64_t cycle) const {
        return anchor_ticks_ + (static_cast<double>(static_cast<int64_t>(cycle)) - anchor_cycles_) / rate_;
    }
    // The first cycle at or after that time; 0 before the tile is switched on.
    uint64_t to_cycle(double ticks) const {
        const double cycles = anchor_cycles_ + (ticks - anchor_ticks_) * rate_;
        if (!(cycles > 0)) {
            return 0;
        }
        // A machine of the least x86-64 has an instruction for this, but none for std::ceil, nor for unsigned
        // numbers.
        const auto whole = static_cast<int64_t>(cycles);
        return static_cast<uint64_t>(whole) + (static_cast<double>(whole) < cycles);
    }
    bool drifts() const { return drift_ != 0; }
    void set_drift(double drift, double now) {
        drift_ = drift;
        drift_steps_ = std::floor(now / kDriftTicks);
    }
    double error() const { return error_ + skew_; }
    // From that time on it is by so much faster than it would be.
    void set_skew(double skew, double now) {
        skew_ = skew;
        anchor(now);
    }

    // The rate as of that time, which must not lie before the last one. How far apart calls are changes
    // nothing.
    void follow_drift(double ticks) {
        if (!drifts()) {
            return;
        }
        for (; (drift_steps_ + 1) * kDriftTicks <= ticks; drift_steps_++) {
            error_ = std::clamp(error_ + drift_ * kDriftTicks / kTicksPerSecond, -kMostError, kMostError);
            anchor((drift_steps_ + 1) * kDriftTicks);
        }
    }
    // From that cycle on one cycle takes as long as `divisor` of the crystal's.
    void divide(uint32_t divisor, uint64_t cycle) {
        divisor_ = divisor;
        anchor(to_ticks(cycle));
    }
    void state(avr::Archive& archive) {
        archive(error_, drift_, skew_, anchor_ticks_, anchor_cycles_, rate_, divisor_, drift_steps_);
        archive.require(divisor_ != 0 && std::abs(error_) <= kMostError && rate_ > 0 &&
                            rate_ == (1 + error()) / divisor_ && anchor_cycles_ >= 0,
                        "a clock runs as none does");
    }
    // Whether a clock that has been loaded can have come to a time, and a chip with it to a cycle.
    bool has_come_to(double ticks, uint64_t cycle) const {
        const double now = static_cast<double>(to_cycle(ticks)), there = static_cast<double>(cycle);
        const double steps = std::floor(ticks / kDriftTicks);
        return now - there <= kMostBehind && (!drifts() || std::abs(steps - drift_steps_) <= 1);
    }

  private:
    void anchor(double ticks) {
        if (ticks > anchor_ticks_) {
            anchor_cycles_ += (ticks - anchor_ticks_) * rate_;
            anchor_ticks_ = ticks;
        }
        rate_ = (1 + error()) / divisor_;
    }

    double error_, drift_, skew_ = 0;
    double anchor_ticks_, anchor_cycles_ = 0; // a moment in both measures
    double rate_;                             // cycles per tick from there on
    uint32_t divisor_ = 1;
    double drift_steps_ = 0;
};

} // namespace tilenca
