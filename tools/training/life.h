// The life of a batch of cells, forward and backward; all pointers stay the caller's.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace training {

// Row-major [output][input], in the units of host/tilenca/training/network.py.
struct Net {
    int32_t channels;
    int32_t hidden1;
    int32_t hidden2;
    int32_t rounded; // whole numbers, as on the tile; 0: plain real numbers
    float limit;     // of states and activations
    const float* w1;
    const float* b1;
    const float* w2;
    const float* b2;
    const float* w3;
    const float* b3;
};

// E updates in `rounds` rounds of `cells` cells.
struct Life {
    int32_t cells;
    int32_t rounds;
    const int64_t* counts;  // [rounds] updates of each round
    const int32_t* who;     // [E] the cell that updates
    const int32_t* reads;   // [E][5] rows it perceives: own 0.., as heard `cells`.., nobody's 2 * `cells`
    const uint8_t* arrives; // [rounds][cells] at the end of the round the neighbours hear the cell
};

// What every update saw and did, or the gradients of it; rows padded to 16 floats.
struct Tape {
    float* seen;    // [E][5 C]
    float* hidden1; // [E][H1]
    float* hidden2; // [E][H2]
    float* after;   // [E][C]
};

// `state` [cells][C] in place; fills the tape.
using Forward = void(const Net& net, const Life& life, float* state, const Tape& tape);

// `d_state` [cells][C] in place; fills d.hidden1, d.hidden2, d.after with the gradients of the sums before
// each clamp.
using Backward = void(const Net& net, const Life& life, float* d_state, const Tape& tape, const Tape& d);

#define TRAINING_LIFE(name)                                                                                  \
    namespace name {                                                                                         \
    Forward forward;                                                                                         \
    Backward backward;                                                                                       \
    }
TRAINING_LIFE(any)
TRAINING_LIFE(avx2)
TRAINING_LIFE(avx512)

} // namespace training
