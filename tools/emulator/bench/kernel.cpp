// Forward passes for tools/bench/kernel.py, which marks the functions: assembly, portable C++, float.
// The inputs are in given.h, as are, with FLOATS, the float weights, row-major.
#include <avr/pgmspace.h>
#include <string.h>

#include "core/arithmetic.h"
#include "model/model.h"

using namespace tilenca;
using namespace tilenca::model;

#include "given.h"

int8_t inputs[kMaxInputs + 1];
int16_t state[kChannels];
volatile bool done;

extern "C" {
__attribute__((noinline)) void begins() {
    __asm__ volatile("; differs from finish");
}
__attribute__((noinline)) void finish() {
    __asm__ volatile("");
}
}

static Forward forward(kModel.network);

static void run_assembly() {
    forward.begin(inputs, state);
    while (!forward.done()) {
        forward.step();
    }
}

static void run_portable() {
    static int8_t hidden1[kHidden1 + kBlockOutputs], hidden2[kHidden2 + kBlockOutputs];
    const Network& network = kModel.network;
    hidden_outputs<OneCell>(network.hidden1, inputs, 0, kHidden1, hidden1);
    hidden_outputs<OneCell>(network.hidden2, hidden1, 0, kHidden2, hidden2);
    add_outputs<OneCell>(network.output, hidden2, 0, kChannels, state);
}

#ifdef FLOATS
static void layer(const float* weights, const float* biases, const float* in, uint8_t count, float* out,
                  uint8_t outputs, bool last) {
    for (uint8_t j = 0; j < outputs; ++j) {
        float sum = pgm_read_float(biases++);
        for (uint8_t i = 0; i < count; ++i) {
            sum += pgm_read_float(weights++) * in[i];
        }
        out[j] = last ? out[j] + sum : sum > 0 ? sum : 0;
    }
}

static void run_float() {
    static float in[kNeighbourhood * kChannels], hidden1[kHidden1], hidden2[kHidden2], out[kChannels];
    for (uint8_t i = 0; i < kNeighbourhood * kChannels; ++i) {
        in[i] = inputs[i] * (1 / 64.0f);
    }
    layer(kFloatW1, kFloatB1, in, kNeighbourhood * kChannels, hidden1, kHidden1, false);
    layer(kFloatW2, kFloatB2, hidden1, kHidden1, hidden2, kHidden2, false);
    layer(kFloatW3, kFloatB3, hidden2, kHidden2, out, kChannels, true);
    state[0] = out[0];
}
#endif

static void time(void (*run)(), const int8_t* given, const int16_t* states) {
    memcpy_P(inputs, given, kNeighbourhood * kChannels);
    memcpy_P(state, states, sizeof state);
    begins();
    run();
    finish();
}

int main() {
    for (uint8_t v = 0; v < kGiven; ++v) {
        time(run_assembly, kInputs[v], kStates[v]);
    }
    time(run_portable, kInputs[0], kStates[0]);
#ifdef FLOATS
    time(run_float, kInputs[0], kStates[0]);
#endif
    done = true;
    for (;;) {
    }
}
