// What the tiles of a group of runs show, and how many of each run are right.
#pragma once

#include <stdint.h>

#include <vector>

#include "schedule.h"
#include "tilenca/simulator.h"

namespace tilenca {

constexpr int8_t kDark = -1;

class Display {
  public:
    // Of the runs [first, last) of the setup; `shown` [cells of the group] is written in place. Those the
    // schedule counts are asked.
    Display(const tilenca_setup& setup, int first, int last, const Schedule& schedule, int8_t* shown);

    void show(int cell, int8_t what) {
        if (counted_[cell]) {
            right_[run_[cell]] += (what == target_[cell]) - (shown_[cell] == target_[cell]);
        }
        shown_[cell] = what;
    }

    // The cell counts from now on, or no more.
    void count(int cell, bool counts) {
        const int sign = int{counts} - int{counted_[cell]};
        total_[run_[cell]] += sign;
        right_[run_[cell]] += sign * (shown_[cell] == target_[cell]);
        counted_[cell] = counts;
    }

    // For every run the share of tiles that are right, of those asked.
    void shares(float* shares) const;

  private:
    const int8_t* target_;
    int8_t* shown_;
    std::vector<uint8_t> counted_;
    std::vector<int32_t> run_;   // [cell]
    std::vector<int32_t> right_; // [run]
    std::vector<int32_t> total_; // [run]
};

} // namespace tilenca
