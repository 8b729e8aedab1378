// Two random halves a step: twice per step a random half of the cells updates, and its messages arrive at
// once.
#pragma once

#include "schedule.h"

namespace tilenca {

class Halves : public Schedule {
  public:
    Halves(const tilenca_setup& setup, int first, int last);

  private:
    void plan(Tick& tick) override;
    void switch_off(int) override {}
    void switch_on(int cell) override { sending_.push_back(cell); }

    void deliver(Tick& tick);

    std::vector<int32_t> sending_; // updated in the tick before, or was switched on now
    std::vector<uint8_t> sent_;    // marks them
};

} // namespace tilenca
