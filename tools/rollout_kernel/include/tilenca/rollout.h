// Training's inner loop: rollouts of a batch of cells, forward, and the gradients backward. Plain C99.
// host/tilenca/training says in plain PyTorch what this computes.
//
// Conventions. All arrays are row-major and stay the caller's.
// A function that fails returns -1, and tilenca_rollout_last_error says why in one line. Every number and
// index given is checked. Calls do not depend on each other, and may run at once.
#ifndef TILENCA_ROLLOUT_H
#define TILENCA_ROLLOUT_H

#include <stddef.h>
#include <stdint.h>

#include "tilenca/api.h"

#ifdef __cplusplus
extern "C" {
#endif

// Grows with every change after which callers must be compiled or written anew.
enum { TILENCA_ROLLOUT_ABI_VERSION = 1 };

// Rows of a tape are padded to a multiple of so many floats.
enum { TILENCA_ROLLOUT_PADDING = 16 };

// A network 5 C -> H1 -> H2 -> C; weights [output][input], as real numbers.
typedef struct tilenca_rollout_network {
    int32_t channels; // C
    int32_t hidden1;  // H1
    int32_t hidden2;  // H2
    int32_t rounded;  // messages and activations are whole numbers, as on the tile; 0: real numbers
    float limit;      // of states and activations
    const float* w1;
    const float* b1;
    const float* w2;
    const float* b2;
    const float* w3;
    const float* b3;
} tilenca_rollout_network;

// E updates of N cells in T ticks. The messages of a tick are rows of a table: the cells' own messages of now
// (0 to N-1), the messages that their neighbours hold of them (N to 2 N - 1), and a row of zeros (2 N).
typedef struct tilenca_rollout_schedule {
    int32_t cells;            // N
    int32_t ticks;            // T
    const int64_t* counts;    // [T] updates of each tick; their sum is E
    const int32_t* updating;  // [E] the cell that updates, each at most once a tick
    const int32_t* perceived; // [E][5] rows of messages: own, N, E, S, W
    const uint8_t* delivered; // [T][N] at the end of the tick the neighbours receive the cell's message
} tilenca_rollout_schedule;

// What every update read and computed, or the gradients of it. Rows are padded.
typedef struct tilenca_rollout_tape {
    float* inputs;  // [E][5 C]
    float* hidden1; // [E][H1]
    float* hidden2; // [E][H2]
    float* after;   // [E][C], the new states
} tilenca_rollout_tape;

// TILENCA_ROLLOUT_ABI_VERSION of the header that the library was compiled with.
TILENCA_API int tilenca_rollout_abi_version(void);
// The bytes of a structure above, by its name ("tilenca_rollout_tape"); 0: there is none of that name.
TILENCA_API size_t tilenca_rollout_size_of(const char* structure);
// Why the last function failed that failed in this thread; valid until the next one fails.
TILENCA_API const char* tilenca_rollout_last_error(void);
// For which kind of processor the code is that runs here: "any", "avx2" or "avx512".
TILENCA_API const char* tilenca_rollout_kind(void);

// Runs the schedule. `state` [N][C] changes in place; the whole tape is written.
TILENCA_API int tilenca_rollout_forward(const tilenca_rollout_network* network,
                                        const tilenca_rollout_schedule* schedule, float* state,
                                        const tilenca_rollout_tape* tape);
// From the gradient of the states at the end, `d_state` [N][C], makes that of the states at the beginning, in
// place. Writes hidden1, hidden2 and after of `gradients`: those of the sums before each clamp. `tape` is
// what forward wrote.
TILENCA_API int tilenca_rollout_backward(const tilenca_rollout_network* network,
                                         const tilenca_rollout_schedule* schedule, float* d_state,
                                         const tilenca_rollout_tape* tape,
                                         const tilenca_rollout_tape* gradients);

#ifdef __cplusplus
}
#endif

#endif
