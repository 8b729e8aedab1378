#include "core/network.h"

namespace tilenca {

namespace {

uint8_t smaller(uint8_t a, uint8_t b) {
    return a < b ? a : b;
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

Decision decide(const int16_t* scores, uint8_t classes) {
    const uint8_t best = best_class(scores, classes);
    uint16_t least = UINT16_MAX;
    for (uint8_t k = 0; k < classes; ++k) {
        const uint16_t ahead = static_cast<uint16_t>(scores[best] - scores[k]);
        if (k != best && ahead < least) {
            least = ahead;
        }
    }
    if (classes == 1) {
        return {best, Decision::kNoMargin};
    }
    return {best, static_cast<uint8_t>((least + (1 << (kMessageShift - 1))) >> kMessageShift)};
}

uint8_t missing_side(const int8_t* scores) {
    uint8_t found = kSides;
    int8_t most = kMissing;
    for (uint8_t side = 0; side < kSides; ++side) {
        if (scores[side] > most) {
            most = scores[side];
            found = side;
        }
    }
    return found;
}

void Forward::begin(int8_t* inputs, int16_t* state) {
    const uint8_t count = network_.hidden1.inputs;
    inputs[count] = kEnd;
    state_ = state;
    const Layer& layer = network_.hidden1;
    const int16_t sum = layer.only_16_bit ? 0 : sum_of_messages(inputs, network_.channels());
    begin_layer(layer, {inputs, sum}, Stage::Hidden1);
}

void Forward::begin_layer(const Layer& layer, const Inputs& inputs, Stage stage) {
    uint8_t slice = 0;
    for (int16_t rows = kRowsPerSlice; rows >= layer.inputs && slice < layer.outputs; rows -= layer.inputs) {
        slice += kBlockOutputs;
    }
    slice_ = slice;
    layer_ = &layer;
    inputs_ = inputs;
    sum_ = 0;
    from_ = 0;
    stage_ = stage;
}

// Calls cost more than they are worth here.
__attribute__((flatten)) void Forward::step() {
    if (done()) {
        return;
    }
    const Layer& layer = *layer_;
    const uint8_t from = from_;
    const uint8_t to = from + smaller(slice_, layer.outputs - from);
    if (stage_ == Stage::Output) {
        add_outputs(layer, inputs_, from, to, state_);
    } else {
        sum_ += hidden_outputs(layer, inputs_, from, to, hidden());
    }
    from_ = to;
    if (to == layer.outputs) {
        next_layer();
    }
}

void Forward::next_layer() {
    if (stage_ == Stage::Output) {
        stage_ = Stage::Done;
        return;
    }
    int8_t* outputs = hidden();
    outputs[layer_->outputs] = kEnd;
    const bool first = stage_ == Stage::Hidden1;
    begin_layer(first ? network_.hidden2 : network_.output, {outputs, sum_},
                first ? Stage::Hidden2 : Stage::Output);
}

} // namespace tilenca
