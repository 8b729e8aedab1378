// The C interface that host/tilenca/training/rollout_kernel.py calls: picks the code for this machine's processor.
#include "life.h"

using namespace training;

namespace {

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

} // namespace

extern "C" {

__attribute__((visibility("default"))) const char* tilenca_life_kind() {
    return kChoice.name;
}

__attribute__((visibility("default"))) void tilenca_life_forward(const Net* net, const Life* life,
                                                                 float* state, const Tape* tape) {
    kChoice.forward(*net, *life, state, *tape);
}

__attribute__((visibility("default"))) void
tilenca_life_backward(const Net* net, const Life* life, float* d_state, const Tape* tape, const Tape* d) {
    kChoice.backward(*net, *life, d_state, *tape, *d);
}

} // extern "C"
