// The schedule of real tiles: each has its phase, period and latency, and starts when it is switched on.
//
// It sends its seed state at once, and updates one period after that (docs/PROTOCOL.md section 1).
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

    void boot(int cell, int64_t at);
    void update(int cell, Tick& tick);

    enum class Next : uint8_t { Boot, Arrival, Update };

    const int64_t* period_;
    const int64_t* latency_;
    std::vector<int32_t> due_;         // [cell], the tick of its next event
    std::vector<Next> next_;           // [cell], what that event is
    std::vector<int64_t> next_update_; // [cell], in units
    std::vector<int32_t> now_due_;     // those whose event is now
    std::vector<int32_t> running_;     // those whose neighbours have their message before the first tick
};

} // namespace tilenca
