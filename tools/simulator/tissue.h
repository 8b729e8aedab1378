// Many runs, each a drawing full of tiles, living side by side.
#pragma once

#include <stdint.h>

#include <memory>
#include <vector>

#include "cells.h"
#include "display.h"
#include "packed.h"
#include "schedule.h"
#include "setup.h"

namespace tilenca {

// What run() writes; null: not wanted.
struct Course {
    float* right;  // [steps][runs], share of the tiles asked that are right after each step
    int8_t* shown; // [steps][cells], what each shows
};

// Runs know nothing of each other. They live in groups that are large enough to fill the processor's vectors
// and small enough for its cache, and threads take whole groups: results depend on neither.
class Tissue {
  public:
    // `states` [cells][C] and `shown` [cells] change in place; they and the setup must outlive the tissue.
    Tissue(const PackedNetwork& network, uint8_t classes, const TilencaSetup& setup, int16_t* states,
           int8_t* shown);

    // Lives on for some steps.
    void run(int steps, int threads, const Course& course);

    // How many updates were computed in all.
    uint64_t updates() const;

  private:
    struct Group {
        Group(const Tissue& tissue, int first, int last, int16_t* states, int8_t* shown);
        void run(int steps, const TilencaSetup& setup, const Course& course);

        int first, last; // runs
        int8_t* shown;
        std::unique_ptr<Schedule> schedule;
        Display display;
        Cells cells;
        Round round;
    };

    PackedNetwork network_;
    uint8_t classes_;
    TilencaSetup setup_;
    std::vector<std::unique_ptr<Group>> groups_;
};

} // namespace tilenca
