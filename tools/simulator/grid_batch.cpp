#include "grid_batch.h"

#include <string.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace tilenca {

namespace {

// How many cells a group has. On clocks a twentieth of them updates at a time, which should fill some
// vectors; and several threads want several groups.
int group_cells(int cells) {
    return std::max(1024, std::min(cells / 8, 4096));
}

} // namespace

GridBatch::Group::Group(const GridBatch& batch, int first, int last, int16_t* states, int8_t* shown)
    : first_(first), last_(last), shown_(shown), schedule_(make_schedule(batch.setup_, first, last)),
      display_(batch.setup_, first, last, *schedule_, shown),
      cells_(batch.network_, batch.classes_, batch.setup_.starts[last] - batch.setup_.starts[first], states) {
}

void GridBatch::Group::run(int steps, const tilenca_setup& setup, const Trajectory& trajectory) {
    const int32_t begin = setup.starts[first_], end = setup.starts[last_];
    for (int step = 0; step < steps; ++step) {
        bool is_last = false;
        while (!is_last) {
            is_last = schedule_->next(tick_);
            cells_.apply(tick_, schedule_->links(), display_);
        }
        display_.shares(trajectory.right + static_cast<size_t>(step) * setup.runs + first_);
        if (trajectory.shown != nullptr) {
            memcpy(trajectory.shown + static_cast<size_t>(step) * setup.cells + begin, shown_, end - begin);
        }
    }
}

GridBatch::GridBatch(const PackedNetwork& network, uint8_t classes, const tilenca_setup& setup,
                     int16_t* states, int8_t* shown)
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

void GridBatch::run(int steps, int threads, const Trajectory& trajectory) {
    std::atomic<size_t> next{0};
    std::mutex failing;
    std::exception_ptr failure;
    const auto work = [&]() noexcept { // an exception that left a thread's function would end the program
        try {
            for (size_t taken = next++; taken < groups_.size(); taken = next++) {
                groups_[taken]->run(steps, setup_, trajectory);
            }
        } catch (...) {
            const std::lock_guard<std::mutex> lock(failing);
            failure = std::current_exception();
        }
    };
    const size_t wanted = std::min<size_t>(threads, groups_.size());
    std::vector<std::thread> others;
    others.reserve(wanted);
    try {
        while (others.size() + 1 < wanted) {
            others.emplace_back(work);
        }
    } catch (const std::exception&) { // std::system_error, or no memory
        // The machine gives no more threads: those that are there do the work of all.
    }
    work();
    for (std::thread& other : others) {
        other.join();
    }
    if (failure != nullptr) {
        std::rethrow_exception(failure);
    }
}

uint64_t GridBatch::updates() const {
    uint64_t total = 0;
    for (const auto& group : groups_) {
        total += group->updates();
    }
    return total;
}

} // namespace tilenca
