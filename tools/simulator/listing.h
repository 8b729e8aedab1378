// The paper's listing: one cell after another, drawn with replacement, as many in a step as a run has cells.
#pragma once

#include "schedule.h"

namespace tilenca {

// A tick has one draw of each run, and delivers the message of the draw before. The last tick of a step only
// delivers; runs with fewer cells rest for the remaining ticks. Times of links are steps, so that what a run
// does depends on no other run.
class Listing : public Schedule {
  public:
    Listing(const tilenca_setup& setup, int first, int last);

  private:
    void plan(Tick& tick) override;
    void switch_off(int) override {}
    void switch_on(int cell) override { sending_.push_back(cell); }

    void draw(size_t run, int step, Tick& tick);

    std::vector<int32_t> sending_; // drawn in the tick before, or switched on now
};

} // namespace tilenca
