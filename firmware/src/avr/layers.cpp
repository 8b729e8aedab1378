// The layers of core/network.h by the assembly beside this file. A program has either this file or
// core/layers.cpp.
#include "core/network.h"

extern "C" {
int16_t tilenca_blocks(uint16_t blocks, const int8_t* inputs, int16_t sum, void* results, uint8_t count);
int16_t tilenca_sum(const int8_t* messages, uint8_t fives);
}

namespace tilenca {

namespace {

constexpr uint8_t kToState = 0x80; // bit 7 of a count
static_assert(kNeighbourhood == 5, "tilenca_sum");

uint16_t address_of(const Layer& layer, uint8_t output) {
    return layer.stream.address() + layer.start_of(output);
}

} // namespace

int16_t sum_of_messages(const int8_t* messages, uint8_t channels) {
    return tilenca_sum(messages, channels);
}

int16_t hidden_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int8_t* outputs) {
    return tilenca_blocks(address_of(layer, from), inputs.values, inputs.sum, outputs + from, to - from);
}

void add_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int16_t* state) {
    tilenca_blocks(address_of(layer, from), inputs.values, inputs.sum, state + from, kToState | (to - from));
}

} // namespace tilenca
