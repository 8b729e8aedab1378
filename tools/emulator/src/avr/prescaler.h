// What divides the clock for timers: it counts on whatever they do, until a program sets it back.
//
// Timers 0, 1, 3, 4 and 5 share one; timer 2 has its own (data sheet, sections 18.1 and 20.10).
#pragma once

#include "avr/archive.h"

#include <cstdint>

namespace tilenca::avr {

class Prescaler {
  public:
    // Cycles it has counted by then.
    uint64_t count(uint64_t cycle) const { return cycle - origin_; }
    // The cycle at which it has counted so far.
    uint64_t when(uint64_t count) const { return origin_ + count; }
    void restart(uint64_t cycle) { origin_ = cycle; }
    // Its clock stands, or runs on from where it stood.
    void set_stands(bool stands, uint64_t cycle) {
        if (stands && !stands_) {
            stands_since_ = cycle;
        } else if (!stands && stands_) {
            origin_ += cycle - stands_since_;
        }
        stands_ = stands;
    }
    // A chip that is reset.
    void reset(uint64_t cycle) { *this = Prescaler(cycle); }
    void state(Archive& archive) { archive(origin_, stands_since_, stands_); }

    Prescaler() = default;

  private:
    explicit Prescaler(uint64_t origin) : origin_(origin) {}

    uint64_t origin_ = 0, stands_since_ = 0;
    bool stands_ = false;
};

} // namespace tilenca::avr
