// The kernel, once for each kind of processor; api.cpp picks one.
#pragma once

#include "tilenca/rollout.h"

namespace rollout {

using Network = tilenca_rollout_network;
using Schedule = tilenca_rollout_schedule;
using Tape = tilenca_rollout_tape;

// As the public header says, without its checks.
using Forward = void(const Network& network, const Schedule& schedule, float* state, const Tape& tape);
using Backward = void(const Network& network, const Schedule& schedule, float* d_state, const Tape& tape,
                      const Tape& gradients);

#define ROLLOUT_DECLARE(kind)                                                                                \
    namespace kind {                                                                                         \
    Forward forward;                                                                                         \
    Backward backward;                                                                                       \
    }
ROLLOUT_DECLARE(any)
ROLLOUT_DECLARE(avx2)
ROLLOUT_DECLARE(avx512)

} // namespace rollout
