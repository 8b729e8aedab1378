// The arithmetic of a layer, docs/PROTOCOL.md section 4, written once for the chip and for the host.
//
// `Lanes` gives the types, and how many outputs of how many cells are computed side by side: one output of
// one cell on the chip (OneCell), many on the host (tools/simulator/lanes.h). It has
//
//   Outputs                         the outputs that are side by side, of all cells
//   State                           the same for stored state values
//   sum(bias)                       the start of a sum
//   multiply_add(sum, weight, x)    sum += weight * x
//   whole(sum)                      the sum as integers: they add and shift like an int32_t
//   clamp(integers, low, high)      each of them within low..high
//   outputs(integers)               as Outputs, and state(integers) as State
//
// Its layers have `inputs`, bias(j), and row(j), whose next() is the weight of the next input.
#pragma once

#include <stdint.h>

#include "core/network.h"

namespace tilenca {

struct OneCell {
    using Outputs = int8_t;
    using State = int16_t;

    static int32_t sum(int16_t bias) { return bias; }
    static void multiply_add(int32_t& sum, int8_t weight, int8_t input) {
        sum += static_cast<int16_t>(weight * input);
    }
    static int32_t whole(int32_t sum) { return sum; }
    static int16_t clamp(int32_t value, int16_t low, int16_t high) {
        if (value < low) {
            return low;
        }
        return value > high ? high : static_cast<int16_t>(value);
    }
    static int8_t outputs(int16_t value) { return static_cast<int8_t>(value); }
    static int16_t state(int16_t value) { return value; }
};

// 24 bits hold the sum: 255 products of at most 127 * 127 and a 16-bit bias need 23 and the sign.
template <class Lanes, class Layer, class Inputs>
auto accumulate(const Layer& layer, uint8_t output, const Inputs* inputs) {
    auto row = layer.row(output);
    auto sum = Lanes::sum(layer.bias(output));
    for (uint8_t i = 0; i < layer.inputs; ++i) {
        Lanes::multiply_add(sum, row.next(), inputs[i]);
    }
    return Lanes::whole(sum);
}

// Outputs [from, to) of a hidden layer, each 0..127.
template <class Lanes, class Layer, class Inputs>
void hidden_outputs(const Layer& layer, const Inputs* inputs, uint8_t from, uint8_t to,
                    typename Lanes::Outputs* outputs) {
    for (uint8_t j = from; j < to; ++j) {
        const auto rounded = (accumulate<Lanes>(layer, j, inputs) + kHiddenRounding) >> kHiddenShift;
        outputs[j] = Lanes::outputs(Lanes::clamp(rounded, 0, kHiddenMax));
    }
}

// Adds outputs [from, to) of the last layer to the state, saturating at +-kStateMax.
template <class Lanes, class Layer, class Inputs>
void add_outputs(const Layer& layer, const Inputs* inputs, uint8_t from, uint8_t to,
                 typename Lanes::State* state) {
    for (uint8_t c = from; c < to; ++c) {
        state[c] =
            Lanes::state(Lanes::clamp(state[c] + accumulate<Lanes>(layer, c, inputs), -kStateMax, kStateMax));
    }
}

} // namespace tilenca
