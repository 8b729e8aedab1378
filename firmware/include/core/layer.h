// A dense layer. Its weights are in flash as packed blocks, in the order in which the kernel reads them:
// docs/PROTOCOL.md section 4.
#pragma once

#include <stdint.h>

#include "core/flash.h"

namespace tilenca {

constexpr uint8_t kBlockOutputs = 8; // outputs computed side by side
constexpr int8_t kEnd = -128;        // follows the last input; no message and no activation has this value

// A packed block is a head of one byte, a bias per output, and then for each input a weight per output. The
// head is the number of inputs where a 16-bit accumulator holds every sum of the block, whatever the inputs;
// otherwise it is 0, and the block has bias + 32768 and weight + 128 in place of biases and weights. Outputs
// that the last block lacks have biases and weights of zero.
struct Layer {
    uint8_t inputs;
    uint8_t outputs;
    FlashView<uint8_t> stream;
    bool only_16_bit; // every block has 16-bit accumulators, so the sum of the inputs is not needed
    uint8_t rounding; // included in the biases of blocks with 16-bit accumulators

    class Row {
      public:
        Row(FlashColumn<kBlockOutputs> column, uint8_t sign) : column_(column), sign_(sign) {}
        int8_t next() { return static_cast<int8_t>(column_.next() ^ sign_); }

      private:
        FlashColumn<kBlockOutputs> column_;
        uint8_t sign_;
    };

    // The weights of an output, one input after the other.
    Row row(uint8_t output) const {
        const uint16_t weights = start_of(output) + kBlockHead + output % kBlockOutputs;
        return Row(stream.column<kBlockOutputs>(weights), sign(output));
    }
    int16_t bias(uint8_t output) const {
        const uint16_t low = start_of(output) + 1 + output % kBlockOutputs * sizeof(int16_t);
        const uint16_t stored = static_cast<uint16_t>(stream[low] | (stream[low + 1] ^ sign(output)) << 8);
        return static_cast<int16_t>(is_16_bit(output) ? stored - rounding : stored);
    }
    bool is_16_bit(uint8_t output) const { return stream[start_of(output)] != 0; }

    // Where the block of an output begins in the stream.
    uint16_t start_of(uint8_t output) const {
        return output / kBlockOutputs * static_cast<uint16_t>(kBlockHead + kBlockOutputs * inputs);
    }

    static constexpr uint8_t kBlockHead = 1 + kBlockOutputs * sizeof(int16_t);

  private:
    // Flips the top bit of a stored byte, which takes its offset off.
    uint8_t sign(uint8_t output) const { return is_16_bit(output) ? 0 : 0x80; }
};

} // namespace tilenca
