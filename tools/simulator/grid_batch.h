// A batch of runs, each a grid of cells, computed side by side.
#pragma once

#include <stdint.h>

#include <memory>
#include <vector>

#include "cells.h"
#include "display.h"
#include "packed.h"
#include "schedule.h"
#include "tilenca/simulator.h"

namespace tilenca {

// What run() writes; null: not wanted.
struct Trajectory {
    float* right;  // [steps][runs], share of the counted tiles that are right after each step
    int8_t* shown; // [steps][cells], what each shows
};

// No run depends on another. They are computed in groups that are large enough to fill the processor's
// vectors and small enough for its cache. Threads take whole groups. Results depend on neither.
class GridBatch {
  public:
    // `states` [cells][C] and `shown` [cells] change in place; they and the setup must outlive the batch.
    GridBatch(const PackedNetwork& network, uint8_t classes, const tilenca_setup& setup, int16_t* states,
              int8_t* shown);

    // Goes on for some steps.
    void run(int steps, int threads, const Trajectory& trajectory);

    // How many updates were computed in all.
    uint64_t updates() const;

  private:
    class Group {
      public:
        // Of the runs [first, last).
        Group(const GridBatch& batch, int first, int last, int16_t* states, int8_t* shown);
        void run(int steps, const tilenca_setup& setup, const Trajectory& trajectory);
        uint64_t updates() const { return cells_.updates(); }

      private:
        int first_, last_;
        int8_t* shown_;
        std::unique_ptr<Schedule> schedule_;
        Display display_;
        Cells cells_;
        Tick tick_;
    };

    PackedNetwork network_;
    uint8_t classes_;
    tilenca_setup setup_;
    std::vector<std::unique_ptr<Group>> groups_;
};

} // namespace tilenca
