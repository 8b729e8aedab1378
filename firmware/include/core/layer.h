// A dense layer, its weights in flash in the order in which the kernel reads them: docs/PROTOCOL.md
// section 4.
#pragma once

#include <stdint.h>

#include "core/flash.h"

namespace tilenca {

constexpr uint8_t kPassOutputs = 8; // outputs computed side by side
constexpr uint8_t kNarrow = 1;      // of a pass: no sum of it leaves 16 bits, whatever the inputs
constexpr uint8_t kWide = 0;
constexpr int8_t kEnd = -128; // behind the last input; no message and no activation is that

// For each pass: a bias per output, then for each input a weight per output, as weight + 128. The outputs
// that the last pass lacks have zeros.
struct Layer {
    uint8_t inputs;
    uint8_t outputs;
    FlashView<uint8_t> stream;

    class Row {
      public:
        explicit Row(FlashColumn<kPassOutputs> column) : column_(column) {}
        int8_t next() { return static_cast<int8_t>(column_.next() ^ 0x80); }

      private:
        FlashColumn<kPassOutputs> column_;
    };

    // The weights of an output, one input after the other.
    Row row(uint8_t output) const {
        const uint16_t weights = start_of(output) + kPassHead + output % kPassOutputs;
        return Row(stream.column<kPassOutputs>(weights));
    }
    int16_t bias(uint8_t output) const {
        const uint16_t low = start_of(output) + 1 + output % kPassOutputs * sizeof(int16_t);
        return static_cast<int16_t>(stream[low] | (stream[low + 1] ^ 0x80) << 8);
    }
    bool narrow(uint8_t output) const { return stream[start_of(output)] == kNarrow; }

    // Where the pass of an output begins in the stream.
    uint16_t start_of(uint8_t output) const {
        return output / kPassOutputs * static_cast<uint16_t>(kPassHead + kPassOutputs * inputs);
    }

#ifdef __AVR__
    uint16_t address_of(uint8_t output) const { return stream.address() + start_of(output); }
#endif

    static constexpr uint8_t kPassHead = 1 + kPassOutputs * sizeof(int16_t);
};

} // namespace tilenca
