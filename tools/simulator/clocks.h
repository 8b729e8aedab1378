// The schedule of real tiles: each has its phase, period and latency, and starts when it is switched on.
#pragma once

#include "schedule.h"

namespace tilenca {

class Clocks : public Schedule {
  public:
    Clocks(const tilenca_setup& setup, int first, int last);

  private:
    void plan(Tick& tick) override;
    void switch_off(int cell) override;
    void switch_on(int cell) override;

    void update(int cell, Tick& tick);

    const int64_t* period_;
    const int64_t* latency_;
    std::vector<int32_t> due_;         // [cell], the tick of its next event
    std::vector<uint8_t> sending_;     // [cell], that event is the arrival of its message, else its update
    std::vector<int64_t> next_update_; // [cell], in units
    std::vector<int32_t> now_due_;     // those whose event is now
};

} // namespace tilenca
