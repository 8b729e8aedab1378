// The C interface: checks what callers give, and picks the code for this machine's processor.
#include "c_api/guard.h"
#include "kernel.h"

using namespace rollout;
using namespace tilenca::c_api;

namespace {

constexpr int32_t kMostChannels = 1 << 12, kMostHidden = 1 << 15;

struct Choice {
    Forward* forward;
    Backward* backward;
    const char* name;
};

Choice choose() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")) {
        return {avx512::forward, avx512::backward, "avx512"};
    }
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return {avx2::forward, avx2::backward, "avx2"};
    }
#endif
    return {any::forward, any::backward, "any"};
}

const Choice kChoice = choose();

void check_network(const Network& network) {
    check_range<int32_t>("the number of channels", network.channels, 1, kMostChannels);
    check_range<int32_t>("the width of the first hidden layer", network.hidden1, 1, kMostHidden);
    check_range<int32_t>("the width of the second hidden layer", network.hidden2, 1, kMostHidden);
    for (const float* array : {network.w1, network.b1, network.w2, network.b2, network.w3, network.b3}) {
        present(array, "an array of the network");
    }
}

// Returns the number of updates.
int64_t check_schedule(const Schedule& schedule) {
    check_range<int32_t>("the number of cells", schedule.cells, 0, INT32_MAX / 2 - 1);
    check_range<int32_t>("the number of ticks", schedule.ticks, 0, INT32_MAX);
    int64_t updates = 0;
    if (schedule.ticks > 0) {
        present(schedule.counts, "counts");
    }
    for (int32_t tick = 0; tick < schedule.ticks; ++tick) {
        check_range<int64_t>("the number of updates of a tick", schedule.counts[tick], 0, schedule.cells);
        updates += schedule.counts[tick];
    }
    if (schedule.ticks > 0 && schedule.cells > 0) {
        present(schedule.delivered, "delivered");
    }
    if (updates > 0) {
        present(schedule.updating, "updating");
        present(schedule.perceived, "perceived");
    }
    for (int64_t i = 0; i < updates; ++i) {
        check_index("updating cell", schedule.updating[i], schedule.cells);
    }
    for (int64_t i = 0; i < 5 * updates; ++i) {
        check_index("row of messages", schedule.perceived[i], 2 * int64_t{schedule.cells} + 1);
    }
    return updates;
}

void check_tape(const Tape* tape, int64_t updates) {
    present(tape, "a tape");
    for (const float* array : {tape->hidden1, tape->hidden2, tape->after}) {
        if (array == nullptr && updates > 0) {
            throw Refusal("an array of a tape is null");
        }
    }
}

// Returns the number of updates.
int64_t check(const Network* network, const Schedule* schedule, const float* state) {
    check_network(present(network, "the network"));
    const int64_t updates = check_schedule(present(schedule, "the schedule"));
    if (schedule->cells > 0) {
        present(state, "the array of states");
    }
    return updates;
}

} // namespace

int tilenca_rollout_abi_version(void) {
    return TILENCA_ROLLOUT_ABI_VERSION;
}

size_t tilenca_rollout_size_of(const char* structure) {
    const Size all[] = {TILENCA_SIZE(tilenca_rollout_network), TILENCA_SIZE(tilenca_rollout_schedule),
                        TILENCA_SIZE(tilenca_rollout_tape)};
    return size_among(all, structure);
}

const char* tilenca_rollout_last_error(void) {
    return last_error();
}

const char* tilenca_rollout_kind(void) {
    return kChoice.name;
}

int tilenca_rollout_forward(const Network* network, const Schedule* schedule, float* state,
                            const Tape* tape) {
    return attempted([&] {
        const int64_t updates = check(network, schedule, state);
        check_tape(tape, updates);
        if (updates > 0) {
            present(tape->inputs, "the inputs of a tape");
        }
        kChoice.forward(*network, *schedule, state, *tape);
    });
}

int tilenca_rollout_backward(const Network* network, const Schedule* schedule, float* d_state,
                             const Tape* tape, const Tape* gradients) {
    return attempted([&] {
        const int64_t updates = check(network, schedule, d_state);
        check_tape(tape, updates);
        check_tape(gradients, updates);
        kChoice.backward(*network, *schedule, d_state, *tape, *gradients);
    });
}
