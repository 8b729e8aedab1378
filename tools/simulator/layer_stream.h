// A layer as the firmware reads it (core/layer.h), made on the host from plain weights.
#pragma once

#include <stdint.h>

#include <vector>

#include "core/layer.h"

namespace tilenca {

class LayerStream {
  public:
    // Weights row-major [output][input].
    LayerStream(uint8_t inputs, uint8_t outputs, const int8_t* weights, const int16_t* biases)
        : inputs_(inputs), outputs_(outputs) {
        for (int from = 0; from < outputs; from += kBlockOutputs) {
            bytes_.insert(bytes_.end(), Layer::kBlockHead, 0);
            for (int i = 0; i < inputs; ++i) {
                for (int j = from; j < from + kBlockOutputs; ++j) {
                    bytes_.push_back(static_cast<uint8_t>((j < outputs ? weights[j * inputs + i] : 0) + 128));
                }
            }
        }
        for (int j = 0; j < (outputs + kBlockOutputs - 1) / kBlockOutputs * kBlockOutputs; ++j) {
            set_bias(static_cast<uint8_t>(j), j < outputs ? biases[j] : 0);
        }
    }

    void set_bias(uint8_t output, int16_t bias) {
        const int low = layer().start_of(output) + 1 + output % kBlockOutputs * 2;
        bytes_[low] = static_cast<uint8_t>(bias);
        bytes_[low + 1] = static_cast<uint8_t>(bias >> 8 ^ 0x80);
    }

    // A view of this: it must not outlive it.
    Layer layer() const { return {inputs_, outputs_, FlashView<uint8_t>(bytes_.data()), false, 0}; }

  private:
    uint8_t inputs_;
    uint8_t outputs_;
    std::vector<uint8_t> bytes_;
};

} // namespace tilenca
