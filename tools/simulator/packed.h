// A network's weights as `Lanes` read them: kRows outputs side by side, the last ones padded with zeros.
#pragma once

#include <stdint.h>

#include <vector>

#include "lanes.h"

namespace tilenca {

// One layer, its weights row-major [output][input]; outputs counts blocks of kRows.
struct PackedLayer {
    class Row {
      public:
        explicit Row(const float* first) : next_(first) {}
        const float* next() {
            const float* weights = next_;
            next_ += kRows;
            return weights;
        }

      private:
        const float* next_;
    };

    PackedLayer(uint8_t inputs, uint8_t outputs, const int8_t* weights, const int16_t* biases);

    Row row(uint8_t output) const { return Row(weights.data() + output * inputs * kRows); }
    const float* bias(uint8_t output) const { return biases.data() + output * kRows; }

    uint8_t inputs;
    uint8_t outputs;
    std::vector<float> weights; // [output][input][row]
    std::vector<float> biases;  // [output][row]
};

// 5 C -> H1 -> H2 -> C.
struct PackedNetwork {
    uint8_t channels;
    PackedLayer hidden1;
    PackedLayer hidden2;
    PackedLayer output;
};

} // namespace tilenca
