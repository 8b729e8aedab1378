#include "core/network.h"

namespace tilenca {

namespace {

// 32 bits hold it with room to spare: 255 products of at most 127 * 127 and a 16-bit bias need 23.
int32_t accumulate(const Layer& layer, uint8_t output, const int8_t* inputs) {
    FlashBytes row = layer.weights.bytes_from(static_cast<uint16_t>(output) * layer.inputs);
    int32_t sum = layer.biases[output];
    for (uint8_t i = 0; i < layer.inputs; ++i) {
        sum += static_cast<int16_t>(row.next() * inputs[i]);
    }
    return sum;
}

uint8_t smaller(uint8_t a, uint8_t b) {
    return a < b ? a : b;
}

int16_t clamp(int32_t value, int16_t low, int16_t high) {
    if (value < low) {
        return low;
    }
    return value > high ? high : static_cast<int16_t>(value);
}

} // namespace

void hidden_outputs(const Layer& layer, const int8_t* inputs, uint8_t from, uint8_t to, int8_t* outputs) {
    for (uint8_t j = from; j < to; ++j) {
        const int32_t rounded = (accumulate(layer, j, inputs) + (1 << (kHiddenShift - 1))) >> kHiddenShift;
        outputs[j] = static_cast<int8_t>(clamp(rounded, 0, kHiddenMax));
    }
}

void add_outputs(const Layer& layer, const int8_t* inputs, uint8_t from, uint8_t to, int16_t* state) {
    for (uint8_t c = from; c < to; ++c) {
        state[c] = clamp(state[c] + accumulate(layer, c, inputs), -kStateMax, kStateMax);
    }
}

void Forward::begin(const int8_t* inputs, int16_t* state) {
    inputs_ = inputs;
    state_ = state;
    stage_ = Stage::Hidden1;
    from_ = 0;
}

void Forward::step() {
    const Layer& layer = stage_ == Stage::Hidden1   ? network_.hidden1
                         : stage_ == Stage::Hidden2 ? network_.hidden2
                                                    : network_.output;
    to_ = smaller(kOutputsPerSlice, layer.outputs - from_) + from_;
    switch (stage_) {
    case Stage::Hidden1:
        hidden_outputs(layer, inputs_, from_, to_, hidden1_);
        advance(layer, Stage::Hidden2);
        break;
    case Stage::Hidden2:
        hidden_outputs(layer, hidden1_, from_, to_, hidden2_);
        advance(layer, Stage::Output);
        break;
    case Stage::Output:
        add_outputs(layer, hidden2_, from_, to_, state_);
        advance(layer, Stage::Done);
        break;
    case Stage::Done:
        break;
    }
}

void Forward::advance(const Layer& layer, Stage next) {
    const bool layer_done = to_ == layer.outputs;
    from_ = layer_done ? 0 : to_;
    stage_ = layer_done ? next : stage_;
}

} // namespace tilenca
