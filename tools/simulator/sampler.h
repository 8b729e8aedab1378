// The paper's sampler: twice per step a random half of the cells updates and is heard at once.
#pragma once

#include "schedule.h"

namespace tilenca {

class Sampler : public Schedule {
  public:
    Sampler(const TilencaSetup& setup, int first, int last);

  private:
    void plan(Round& round) override;
    void switch_off(int) override {}
    void switch_on(int) override {}

    void deliver(Round& round);

    std::vector<int32_t> sending_; // those who updated in the round before
    std::vector<uint8_t> sent_;    // marks them
};

} // namespace tilenca
