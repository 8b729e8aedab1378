#include "packed.h"

namespace tilenca {

PackedLayer::PackedLayer(uint8_t inputs, uint8_t outputs, const int8_t* weights, const int16_t* biases)
    : inputs(inputs), outputs((outputs + kRows - 1) / kRows), weights(this->outputs * inputs * kRows),
      biases(this->outputs * kRows) {
    for (int j = 0; j < outputs; ++j) {
        this->biases[j] = biases[j];
        float* block = this->weights.data() + j / kRows * inputs * kRows + j % kRows;
        for (int i = 0; i < inputs; ++i) {
            block[i * kRows] = weights[j * inputs + i];
        }
    }
}

} // namespace tilenca
