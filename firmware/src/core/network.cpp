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
extern "C" int16_t tilenca_passes(uint16_t passes, const int8_t* inputs, int32_t start, void* results,
                                  uint8_t count, bool to_state);

namespace {

// What the offsets of weights and biases in flash add to every sum.
int32_t without_offsets(const Inputs& inputs) {
    return -32768L - inputs.sum * 128L;
}

} // namespace

int16_t hidden_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int8_t* outputs) {
    return tilenca_passes(layer.address_of(from), inputs.values,
                          without_offsets(inputs) + (1 << (kHiddenShift - 1)), outputs + from, to - from,
                          false);
}

void add_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int16_t* state) {
    tilenca_passes(layer.address_of(from), inputs.values, without_offsets(inputs), state + from, to - from,
                   true);
}

#else

int16_t hidden_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int8_t* outputs) {
    const uint8_t end = (to + kPassOutputs - 1) / kPassOutputs * kPassOutputs;
    hidden_outputs<OneCell>(layer, inputs.values, from, end, outputs);
    return sum_of(outputs + from, to - from);
}

void add_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int16_t* state) {
    add_outputs<OneCell>(layer, inputs.values, from, to, state);
}

#endif

void Forward::begin(int8_t* inputs, int16_t* state) {
    const uint8_t count = network_.hidden1.inputs;
    inputs[count] = kEnd;
    state_ = state;
    begin_layer(network_.hidden1, {inputs, sum_of(inputs, count)}, Stage::Hidden1);
}

void Forward::step() {
    switch (stage_) {
    case Stage::Hidden1:
        hidden_step(hidden1_, network_.hidden2, Stage::Hidden2);
        break;
    case Stage::Hidden2:
        hidden_step(hidden2_, network_.output, Stage::Output);
        break;
    case Stage::Output: {
        const uint8_t to = from_ + smaller(slice_, layer_->outputs - from_);
        add_outputs(*layer_, inputs_, from_, to, state_);
        from_ = to;
        stage_ = to == layer_->outputs ? Stage::Done : Stage::Output;
        break;
    }
    case Stage::Done:
        break;
    }
}

void Forward::begin_layer(const Layer& layer, const Inputs& inputs, Stage stage) {
    const uint8_t passes = kRowsPerSlice / layer.inputs;
    slice_ = smaller(passes, kMaxHidden / kPassOutputs) * kPassOutputs;
    layer_ = &layer;
    inputs_ = inputs;
    sum_ = 0;
    from_ = 0;
    stage_ = stage;
}

void Forward::hidden_step(int8_t* outputs, const Layer& next, Stage next_stage) {
    const uint8_t to = from_ + smaller(slice_, layer_->outputs - from_);
    sum_ += hidden_outputs(*layer_, inputs_, from_, to, outputs);
    from_ = to;
    if (to == layer_->outputs) {
        outputs[to] = kEnd;
        begin_layer(next, {outputs, sum_}, next_stage);
    }
}

} // namespace tilenca
