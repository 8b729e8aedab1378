#include "packed.h"

namespace tilenca {

PackedLayer::PackedLayer(uint8_t width_in, uint8_t width_out, const int8_t* dense,
                         const int16_t* dense_biases)
    : inputs(width_in), outputs((width_out + kRows - 1) / kRows), weights(outputs * inputs * kRows),
      biases(outputs * kRows) {
    for (int j = 0; j < width_out; ++j) {
        biases[j] = dense_biases[j];
        float* block = weights.data() + j / kRows * inputs * kRows + j % kRows;
        for (int i = 0; i < inputs; ++i) {
            block[i * kRows] = dense[j * inputs + i];
        }
    }
}

} // namespace tilenca
