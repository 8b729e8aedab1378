#include "setup.h"

#include "c_api/guard.h"
#include "core/network.h"
#include "core/side.h"

namespace tilenca {

namespace {

using c_api::check_range;
using c_api::Refusal;

// Far beyond every run, and sums of two times still fit.
constexpr int64_t kLongest = int64_t{1} << 46;
// The ticks before the first step are run, too: more than these are a mistake, and would take for ever.
constexpr int64_t kEarliest = int64_t{-1000000} * TILENCA_TICKS * TILENCA_UNITS_PER_TICK;

// All arrays must be there, but those that have no elements.
void check_arrays(const tilenca_setup& setup) {
    const void* const of_cells[] = {setup.neighbours, setup.alive};
    const void* const of_clocks[] = {setup.first, setup.period, setup.latency};
    c_api::present(setup.starts, "starts");
    for (const void* array : of_cells) {
        if (array == nullptr && setup.cells > 0) {
            throw Refusal("an array of the setup is null");
        }
    }
    for (const void* array : of_clocks) {
        if (array == nullptr && setup.cells > 0 && setup.schedule == TILENCA_SCHEDULE_CLOCKS) {
            throw Refusal("an array of the clocks is null");
        }
    }
    if (setup.changes_count > 0) {
        c_api::present(setup.changes, "changes");
    }
    if (setup.runs > 0) {
        c_api::present(setup.seeds, "seeds");
        if (setup.fault != TILENCA_FAULT_NONE) {
            c_api::present(setup.faulty, "faulty");
        }
    }
}

void check_run(const tilenca_setup& setup, int run) {
    const int32_t begin = setup.starts[run], end = setup.starts[run + 1];
    const int32_t* const beyond = setup.neighbours + static_cast<size_t>(end) * kSides;
    for (const int32_t* other = setup.neighbours + static_cast<size_t>(begin) * kSides; other != beyond;
         ++other) {
        if (*other != setup.cells && (*other < begin || *other >= end)) {
            throw Refusal("cell " + std::to_string((other - setup.neighbours) / kSides) +
                          " has a neighbour " + std::to_string(*other) + ", which is not of its run");
        }
    }
    if (setup.fault != TILENCA_FAULT_NONE && setup.faulty[run] != -1 &&
        (setup.faulty[run] < begin || setup.faulty[run] >= end)) {
        throw Refusal("the faulty cell " + std::to_string(setup.faulty[run]) + " is not of run " +
                      std::to_string(run));
    }
}

void check_latency(const int64_t* latency, int32_t cell, int side, int64_t period) {
    check_range<int64_t>("a latency", latency[static_cast<size_t>(cell) * kSides + side], 0, period - 1);
}

void check_clocks(const tilenca_setup& setup) {
    check_range<int64_t>("the start", setup.start, kEarliest, 0);
    if (setup.start % TILENCA_UNITS_PER_TICK != 0) {
        throw Refusal("the start is no whole number of ticks");
    }
    for (int side = 0; setup.line != nullptr && side < kSides; ++side) {
        check_range<int64_t>("a time on a line", setup.line[side], 0, kLongest);
    }
    for (int32_t cell = 0; cell < setup.cells; ++cell) {
        check_range<int64_t>("a first update", setup.first[cell], -kLongest, kLongest);
        check_range<int64_t>("a period", setup.period[cell], 1, kLongest);
        for (int side = 0; side < kSides; ++side) {
            check_latency(setup.latency, cell, side, setup.period[cell]);
            if (setup.seed_latency != nullptr) {
                check_latency(setup.seed_latency, cell, side, setup.period[cell]);
            }
        }
    }
}

void check_changes(const tilenca_setup& setup) {
    int32_t before = 0;
    for (int32_t i = 0; i < setup.changes_count; ++i) {
        const tilenca_change& change = setup.changes[i];
        check_range<int32_t>("the step of a change", change.step, before, INT32_MAX);
        check_range<int32_t>("the cell of a change", change.cell, 0, setup.cells - 1);
        check_range<int32_t>("whether a change puts a tile down", change.on, 0, 1);
        before = change.step;
    }
}

} // namespace

void check_model(const tilenca_model& model) {
    check_range<int>("the number of channels", model.channels, 1, kMaxChannels);
    check_range<int>("the width of the first hidden layer", model.hidden1, 1, kMaxHidden);
    check_range<int>("the width of the second hidden layer", model.hidden2, 1, kMaxHidden);
    check_range<int>("the number of classes", model.classes, 1, model.channels);
    for (const void* array : {static_cast<const void*>(model.w1), static_cast<const void*>(model.b1),
                              static_cast<const void*>(model.w2), static_cast<const void*>(model.b2),
                              static_cast<const void*>(model.w3), static_cast<const void*>(model.b3)}) {
        if (array == nullptr) {
            throw Refusal("an array of the model is null");
        }
    }
}

void check_setup(const tilenca_setup& setup) {
    check_range<int32_t>("the number of runs", setup.runs, 0, INT32_MAX - 1);
    check_range<int32_t>("the number of cells", setup.cells, 0, INT32_MAX / kSides);
    check_range<int>("the schedule", setup.schedule, TILENCA_SCHEDULE_HALVES, TILENCA_SCHEDULE_LISTING);
    check_range<int32_t>("the number of changes", setup.changes_count, 0, INT32_MAX);
    check_range<int>("the fault", setup.fault, TILENCA_FAULT_NONE, TILENCA_FAULT_AWAY);
    check_range<uint64_t>("the loss", setup.loss, 0, uint64_t{1} << 32);
    check_arrays(setup);
    if (setup.starts[0] != 0 || setup.starts[setup.runs] != setup.cells) {
        throw Refusal("starts do not go from 0 to the number of cells");
    }
    for (int32_t run = 0; run < setup.runs; ++run) {
        check_range<int32_t>("the end of a run", setup.starts[run + 1], setup.starts[run], setup.cells);
        check_run(setup, run);
    }
    if (setup.schedule == TILENCA_SCHEDULE_CLOCKS) {
        check_clocks(setup);
    }
    check_changes(setup);
}

} // namespace tilenca
