// A dense layer, its weights in flash in the order in which the kernel reads them: docs/PROTOCOL.md
// section 4.
#pragma once

#include <stdint.h>

#include "core/flash.h"

namespace tilenca {

constexpr uint8_t kPassOutputs = 8; // outputs computed side by side
constexpr int8_t kEnd = -128;       // behind the last input; no message and no activation is that

// For each pass: 0, or its number of inputs if no sum of it leaves 16 bits, whatever the inputs; a bias per
// output; then for each input a weight per output. If sums need more than 16 bits, a bias is there as bias +
// 32768 and a weight as weight + 128. The outputs that the last pass lacks have zeros.
struct Layer {
    uint8_t inputs;
    uint8_t outputs;
    FlashView<uint8_t> stream;
    bool narrow_only; // all its passes are: nobody needs the sum of its inputs
    uint8_t rounding; // what biases of narrow passes include

    class Row {
      public:
        Row(FlashColumn<kPassOutputs> column, uint8_t sign) : column_(column), sign_(sign) {}
        int8_t next() { return static_cast<int8_t>(column_.next() ^ sign_); }

      private:
        FlashColumn<kPassOutputs> column_;
        uint8_t sign_;
    };

    // The weights of an output, one input after the other.
    Row row(uint8_t output) const {
        const uint16_t weights = start_of(output) + kPassHead + output % kPassOutputs;
        return Row(stream.column<kPassOutputs>(weights), sign(output));
    }
    int16_t bias(uint8_t output) const {
        const uint16_t low = start_of(output) + 1 + output % kPassOutputs * sizeof(int16_t);
        const uint16_t stored = static_cast<uint16_t>(stream[low] | (stream[low + 1] ^ sign(output)) << 8);
        return static_cast<int16_t>(narrow(output) ? stored - rounding : stored);
    }
    bool narrow(uint8_t output) const { return stream[start_of(output)] != 0; }

    // Where the pass of an output begins in the stream.
    uint16_t start_of(uint8_t output) const {
        return output / kPassOutputs * static_cast<uint16_t>(kPassHead + kPassOutputs * inputs);
    }

    static constexpr uint8_t kPassHead = 1 + kPassOutputs * sizeof(int16_t);

  private:
    // What the top bits of the stream are flipped by.
    uint8_t sign(uint8_t output) const { return narrow(output) ? 0 : 0x80; }
};

} // namespace tilenca
