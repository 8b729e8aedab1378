#include "core/network.h"

#include "core/arithmetic.h"

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

void hidden_outputs(const Layer& layer, const int8_t* inputs, uint8_t from, uint8_t to, int8_t* outputs) {
    hidden_outputs<OneCell>(layer, inputs, from, to, outputs);
}

void add_outputs(const Layer& layer, const int8_t* inputs, uint8_t from, uint8_t to, int16_t* state) {
    add_outputs<OneCell>(layer, inputs, from, to, state);
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
