// A network's weights as `Lanes` read them: kRows outputs side by side, the last ones padded with zeros.
#pragma once

#include <stdint.h>

#include <vector>

#include "lanes.h"

namespace tilenca {

// One layer; `outputs` counts blocks of kRows.
struct PackedLayer {
    class Row {
      public:
        explicit Row(const float* first) : next_(first) {}
        const float* next() {
            const float* row = next_;
            next_ += kRows;
            return row;
        }

      private:
        const float* next_;
    };

    // Dense weights are row-major [output][input].
    PackedLayer(uint8_t width_in, uint8_t width_out, const int8_t* dense, const int16_t* dense_biases);

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
