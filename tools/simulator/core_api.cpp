// The simulator behind a C interface, for models of any size: host/tilenca/simulator/core_library.py and tissue.py call it.
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <memory>
#include <new>
#include <vector>

#include "core/network.h"
#include "layer_stream.h"
#include "schedule.h"
#include "setup.h"
#include "tissue.h"
#include "update.h"

#define TILENCA_API __attribute__((visibility("default")))

extern "C" {

// Weights row-major [output][input]; all pointers stay the caller's.
struct TilencaModel {
    uint8_t channels;
    uint8_t hidden1;
    uint8_t hidden2;
    uint8_t classes;
    const int8_t* w1;
    const int16_t* b1;
    const int8_t* w2;
    const int16_t* b2;
    const int8_t* w3;
    const int16_t* b3;
};

// A round as arrays that are good until the next one is asked for; events are pairs of a cell and its sides.
struct TilencaRound {
    const int32_t* gone;
    const int32_t* born;
    const tilenca::Event* arrivals;
    const tilenca::Event* updates;
    int32_t gone_count;
    int32_t born_count;
    int32_t arrivals_count;
    int32_t updates_count;
};
}

namespace {

tilenca::PackedNetwork packed(const TilencaModel& m) {
    const uint8_t wide = tilenca::kNeighbourhood * m.channels;
    return {m.channels,
            {wide, m.hidden1, m.w1, m.b1},
            {m.hidden1, m.hidden2, m.w2, m.b2},
            {m.hidden2, m.channels, m.w3, m.b3}};
}

void update_as_the_chip_does(const TilencaModel& m, int16_t* states, const int8_t* inputs, size_t count) {
    const uint8_t wide = tilenca::kNeighbourhood * m.channels;
    const tilenca::LayerStream hidden1(wide, m.hidden1, m.w1, m.b1);
    const tilenca::LayerStream hidden2(m.hidden1, m.hidden2, m.w2, m.b2);
    const tilenca::LayerStream output(m.hidden2, m.channels, m.w3, m.b3);
    const tilenca::Network network = {hidden1.layer(), hidden2.layer(), output.layer()};
    tilenca::Forward forward(network);
    int8_t messages[tilenca::kMaxInputs + 1];
    for (size_t i = 0; i < count; ++i) {
        memcpy(messages, inputs + i * wide, wide);
        forward.begin(messages, states + i * m.channels);
        while (!forward.done()) {
            forward.step();
        }
    }
}

// What `make` makes; null where memory does not suffice.
template <class Make>
auto made(Make make) -> decltype(make()) {
    try {
        return make();
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

// A schedule for those who have states of their own kind.
struct Plan {
    explicit Plan(const TilencaSetup& given)
        : setup(given), schedule(tilenca::make_schedule(setup, 0, setup.runs)) {}

    TilencaSetup setup;
    std::unique_ptr<tilenca::Schedule> schedule;
    tilenca::Round round;
};

} // namespace

extern "C" {

// Updates `count` cells in place: states[count][C], inputs[count][5 C] (own message, then N, E, S, W).
// `lanes` go side by side: as many as this machine can (0), so many, or one, by the very code of the chip.
// 0 if this machine cannot.
TILENCA_API int32_t tilenca_update_cells(const TilencaModel* model, int16_t* states, const int8_t* inputs,
                                         size_t count, int32_t lanes) {
    if (lanes == 1) {
        update_as_the_chip_does(*model, states, inputs, count);
        return 1;
    }
    const size_t wide = tilenca::kNeighbourhood * model->channels;
    std::vector<tilenca::CellUpdate> updates(count);
    for (size_t i = 0; i < count; ++i) {
        updates[i] = {inputs + i * wide, states + i * model->channels, 0};
    }
    return tilenca::update_cells(packed(*model), updates.data(), count, lanes);
}

// See tilenca::Tissue; the model's weights are copied.
TILENCA_API tilenca::Tissue* tilenca_tissue_new(const TilencaModel* model, const TilencaSetup* setup,
                                                int16_t* states, int8_t* shown) {
    return made([&] { return new tilenca::Tissue(packed(*model), model->classes, *setup, states, shown); });
}

TILENCA_API void tilenca_tissue_delete(tilenca::Tissue* tissue) {
    delete tissue;
}

TILENCA_API void tilenca_tissue_run(tilenca::Tissue* tissue, int32_t steps, int32_t threads, float* right,
                                    int8_t* shown) {
    tissue->run(steps, threads, {right, shown});
}

TILENCA_API uint64_t tilenca_tissue_updates(const tilenca::Tissue* tissue) {
    return tissue->updates();
}

TILENCA_API void* tilenca_plan_new(const TilencaSetup* setup) {
    return made([&] { return new Plan(*setup); });
}

TILENCA_API void tilenca_plan_delete(void* plan) {
    delete static_cast<Plan*>(plan);
}

// Plans a round; 1 when it is the last one of a step.
TILENCA_API int32_t tilenca_plan_next(void* opaque, TilencaRound* out) {
    Plan& plan = *static_cast<Plan*>(opaque);
    const bool last = plan.schedule->next(plan.round);
    const tilenca::Round& round = plan.round;
    *out = {round.gone.data(),
            round.born.data(),
            round.arrivals.data(),
            round.updates.data(),
            static_cast<int32_t>(round.gone.size()),
            static_cast<int32_t>(round.born.size()),
            static_cast<int32_t>(round.arrivals.size()),
            static_cast<int32_t>(round.updates.size())};
    return last;
}

} // extern "C"
