#include "core/network.h"

#include "core/arithmetic.h"

namespace tilenca {

namespace {

uint8_t smaller(uint8_t a, uint8_t b) {
    return a < b ? a : b;
}

int16_t sum_of(const int8_t* values, uint8_t count) {
    int16_t sum = 0;
    for (const int8_t* end = values + count; values != end; ++values) {
        sum += *values;
    }
    return sum;
}

} // namespace

uint8_t best_class(const int16_t* scores, uint8_t classes) {
    uint8_t best = 0;
    for (uint8_t k = 1; k < classes; ++k) {
        if (scores[k] > scores[best]) {
            best = k;
        }
    }
    return best;
}

#ifdef __AVR__

// firmware/src/avr/kernel.S
extern "C" int16_t tilenca_pass(uint16_t pass, const int8_t* inputs, int32_t start, void* results,
                                uint8_t how);

namespace {

constexpr uint8_t kNarrow = 0x80;

int16_t run_pass(const Layer& layer, const Inputs& inputs, uint8_t from, int32_t start, void* results,
                 uint8_t how) {
    const uint8_t pass = from / kPassOutputs;
    const uint8_t narrow = layer.narrow >> pass & 1 ? kNarrow : 0;
    // The weights in flash are 128 too large.
    return tilenca_pass(layer.stream.address() + layer.start_of(pass), inputs.values,
                        start - 128L * inputs.sum, results, narrow | how);
}

} // namespace

int16_t hidden_pass(const Layer& layer, const Inputs& inputs, uint8_t from, int8_t* outputs) {
    return run_pass(layer, inputs, from, 1 << (kHiddenShift - 1), outputs + from, 0);
}

void output_pass(const Layer& layer, const Inputs& inputs, uint8_t from, int16_t* state) {
    run_pass(layer, inputs, from, 0, state + from, smaller(kPassOutputs, layer.outputs - from));
}

#else

int16_t hidden_pass(const Layer& layer, const Inputs& inputs, uint8_t from, int8_t* outputs) {
    hidden_outputs<OneCell>(layer, inputs.values, from, from + kPassOutputs, outputs);
    return sum_of(outputs + from, kPassOutputs);
}

void output_pass(const Layer& layer, const Inputs& inputs, uint8_t from, int16_t* state) {
    const uint8_t to = from + smaller(kPassOutputs, layer.outputs - from);
    add_outputs<OneCell>(layer, inputs.values, from, to, state);
}

#endif

void Forward::begin(int8_t* inputs, int16_t* state) {
    const uint8_t count = network_.hidden1.inputs;
    inputs[count] = kEnd;
    inputs_ = {inputs, sum_of(inputs, count)};
    state_ = state;
    sum_ = 0;
    stage_ = Stage::Hidden1;
    from_ = 0;
}

void Forward::step() {
    switch (stage_) {
    case Stage::Hidden1:
        hidden_step(network_.hidden1, hidden1_, Stage::Hidden2);
        break;
    case Stage::Hidden2:
        hidden_step(network_.hidden2, hidden2_, Stage::Output);
        break;
    case Stage::Output:
        output_pass(network_.output, inputs_, from_, state_);
        from_ += kPassOutputs;
        stage_ = from_ < network_.output.outputs ? Stage::Output : Stage::Done;
        break;
    case Stage::Done:
        break;
    }
}

void Forward::hidden_step(const Layer& layer, int8_t* outputs, Stage next) {
    sum_ += hidden_pass(layer, inputs_, from_, outputs);
    from_ += kPassOutputs;
    if (from_ >= layer.outputs) {
        outputs[layer.outputs] = kEnd;
        inputs_ = {outputs, sum_};
        sum_ = 0;
        from_ = 0;
        stage_ = next;
    }
}

} // namespace tilenca
