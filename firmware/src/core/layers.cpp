// The layers of core/network.h in portable C++. A program has either this file or avr/layers.cpp.
#include "core/arithmetic.h"
#include "core/network.h"

namespace tilenca {

int16_t sum_of_messages(const int8_t* messages, uint8_t channels) {
    int16_t sum = 0;
    for (uint8_t i = 0; i < kNeighbourhood * channels; ++i) {
        sum += messages[i];
    }
    return sum;
}

int16_t hidden_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int8_t* outputs) {
    const uint8_t end = (to + kBlockOutputs - 1) / kBlockOutputs * kBlockOutputs;
    hidden_outputs<OneCell>(layer, inputs.values, from, end, outputs);
    int16_t sum = 0;
    for (uint8_t j = from; j < to; ++j) {
        sum += outputs[j];
    }
    return sum;
}

void add_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int16_t* state) {
    add_outputs<OneCell>(layer, inputs.values, from, to, state);
}

} // namespace tilenca
