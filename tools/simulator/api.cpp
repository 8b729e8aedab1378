// The simulator's C interface: include/tilenca/simulator.h says what each function does.
#include <string.h>

#include <memory>
#include <vector>

#include "c_api/guard.h"
#include "core/network.h"
#include "grid_batch.h"
#include "layer_stream.h"
#include "schedule.h"
#include "setup.h"
#include "tilenca/simulator.h"
#include "update.h"

using namespace tilenca::c_api;

struct tilenca_grid_batch {
    tilenca::GridBatch batch;
};

struct tilenca_schedule {
    explicit tilenca_schedule(const tilenca_setup& given)
        : setup(given), schedule(tilenca::make_schedule(setup, 0, setup.runs)) {}

    tilenca_setup setup;
    std::unique_ptr<tilenca::Schedule> schedule;
    tilenca::Tick tick;
};

namespace {

tilenca::PackedNetwork packed(const tilenca_model& m) {
    const uint8_t wide = tilenca::kNeighbourhood * m.channels;
    return {m.channels,
            {wide, m.hidden1, m.w1, m.b1},
            {m.hidden1, m.hidden2, m.w2, m.b2},
            {m.hidden2, m.channels, m.w3, m.b3}};
}

void update_by_the_chips_code(const tilenca_model& m, int16_t* states, const int8_t* inputs, size_t count) {
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

bool update_side_by_side(const tilenca_model& m, int16_t* states, const int8_t* inputs, size_t count,
                         int lanes) {
    const size_t wide = tilenca::kNeighbourhood * m.channels;
    std::vector<tilenca::CellUpdate> updates(count);
    for (size_t i = 0; i < count; ++i) {
        updates[i] = {inputs + i * wide, states + i * m.channels, 0};
    }
    return tilenca::update_cells(packed(m), updates.data(), count, lanes);
}

} // namespace

int tilenca_simulator_abi_version(void) {
    return TILENCA_SIMULATOR_ABI_VERSION;
}

size_t tilenca_simulator_size_of(const char* structure) {
    const Size all[] = {TILENCA_SIZE(tilenca_model), TILENCA_SIZE(tilenca_change),
                        TILENCA_SIZE(tilenca_setup), TILENCA_SIZE(tilenca_event), TILENCA_SIZE(tilenca_tick)};
    return size_among(all, structure);
}

const char* tilenca_simulator_last_error(void) {
    return last_error();
}

int tilenca_update_cells(const tilenca_model* model, int16_t* states, const int8_t* inputs, size_t count,
                         int lanes) {
    return guarded(-1, [&] {
        tilenca::check_model(present(model, "the model"));
        if (count != 0) {
            present(states, "the array of states");
            present(inputs, "the array of inputs");
        }
        if (lanes == 1) {
            update_by_the_chips_code(*model, states, inputs, count);
            return 0;
        }
        return update_side_by_side(*model, states, inputs, count, lanes) ? 0 : 1;
    });
}

tilenca_grid_batch* tilenca_grid_batch_new(const tilenca_model* model, const tilenca_setup* setup,
                                           int16_t* states, int8_t* shown) {
    return guarded<tilenca_grid_batch*>(nullptr, [&] {
        tilenca::check_model(present(model, "the model"));
        tilenca::check_setup(present(setup, "the setup"));
        if (setup->cells > 0) {
            present(setup->target, "target");
            present(states, "the array of states");
            present(shown, "the array of what is shown");
        }
        return new tilenca_grid_batch{{packed(*model), model->classes, *setup, states, shown}};
    });
}

void tilenca_grid_batch_free(tilenca_grid_batch* batch) {
    delete batch;
}

int tilenca_grid_batch_run(tilenca_grid_batch* batch, int32_t steps, int32_t threads, float* right,
                           int8_t* shown) {
    return attempted([&] {
        present(batch, "the batch");
        check_range<int32_t>("the number of steps", steps, 0, INT32_MAX);
        check_range<int32_t>("the number of threads", threads, 1, INT32_MAX);
        if (steps > 0) {
            present(right, "the array of shares");
        }
        batch->batch.run(steps, threads, {right, shown});
    });
}

uint64_t tilenca_grid_batch_updates(const tilenca_grid_batch* batch) {
    return batch == nullptr ? 0 : batch->batch.updates();
}

tilenca_schedule* tilenca_schedule_new(const tilenca_setup* setup) {
    return guarded<tilenca_schedule*>(nullptr, [&] {
        tilenca::check_setup(present(setup, "the setup"));
        return new tilenca_schedule(*setup);
    });
}

void tilenca_schedule_free(tilenca_schedule* schedule) {
    delete schedule;
}

int tilenca_schedule_next(tilenca_schedule* schedule, tilenca_tick* tick) {
    return guarded(-1, [&] {
        present(tick, "the place for the tick");
        tilenca::Tick& found = present(schedule, "the schedule").tick;
        const bool last = schedule->schedule->next(found);
        *tick = {found.switched_off.data(),
                 found.switched_on.data(),
                 found.deliveries.data(),
                 found.updates.data(),
                 static_cast<int32_t>(found.switched_off.size()),
                 static_cast<int32_t>(found.switched_on.size()),
                 static_cast<int32_t>(found.deliveries.size()),
                 static_cast<int32_t>(found.updates.size())};
        return int{last};
    });
}
