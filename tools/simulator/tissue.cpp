#include "tissue.h"

#include <string.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace tilenca {

namespace {

// How many cells a group has. On clocks a twentieth of them updates at a time, which should fill some
// vectors; and several threads want several groups.
int group_cells(int cells) {
    return std::max(1024, std::min(cells / 8, 4096));
}

} // namespace

Tissue::Group::Group(const Tissue& tissue, int first, int last, int16_t* states, int8_t* shown)
    : first(first), last(last), shown(shown), schedule(make_schedule(tissue.setup_, first, last)),
      display(tissue.setup_, first, last, *schedule, shown),
      cells(tissue.network_, tissue.classes_, tissue.setup_.starts[last] - tissue.setup_.starts[first],
            states) {}

void Tissue::Group::run(int steps, const TilencaSetup& setup, const Course& course) {
    const int32_t begin = setup.starts[first], end = setup.starts[last];
    for (int step = 0; step < steps; ++step) {
        bool last_round = false;
        while (!last_round) {
            last_round = schedule->next(round);
            cells.live(round, schedule->links(), display);
        }
        display.shares(course.right + static_cast<size_t>(step) * setup.runs + first);
        if (course.shown != nullptr) {
            memcpy(course.shown + static_cast<size_t>(step) * setup.cells + begin, shown, end - begin);
        }
    }
}

Tissue::Tissue(const PackedNetwork& network, uint8_t classes, const TilencaSetup& setup, int16_t* states,
               int8_t* shown)
    : network_(network), classes_(classes), setup_(setup) {
    for (int first = 0, last = 0; first < setup.runs; first = last) {
        const int32_t begin = setup.starts[first];
        do {
            ++last;
        } while (last < setup.runs && setup.starts[last + 1] - begin <= group_cells(setup.cells));
        groups_.push_back(std::make_unique<Group>(
            *this, first, last, states + static_cast<size_t>(begin) * network.channels, shown + begin));
    }
}

void Tissue::run(int steps, int threads, const Course& course) {
    std::atomic<size_t> next{0};
    const auto work = [&] {
        for (size_t taken = next++; taken < groups_.size(); taken = next++) {
            groups_[taken]->run(steps, setup_, course);
        }
    };
    std::vector<std::thread> helpers;
    for (size_t i = 1; i < std::min<size_t>(threads, groups_.size()); ++i) {
        helpers.emplace_back(work);
    }
    work();
    for (std::thread& helper : helpers) {
        helper.join();
    }
}

uint64_t Tissue::updates() const {
    uint64_t total = 0;
    for (const auto& group : groups_) {
        total += group->cells.updates();
    }
    return total;
}

} // namespace tilenca
