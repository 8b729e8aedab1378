// How an asynchronous receiver reads a frame off a wire: by sampling each bit around its centre, three times.
//
// Used by the chip's USARTs in their clock, and by the host's end of the USB serial in its own.
#pragma once

#include "avr/line.h"

#include <cstdint>

namespace tilenca::avr {

struct FrameFormat {
    uint8_t data_bits = 8;
    uint8_t parity = 0; // 0 none, 2 even, 3 odd, as in UCSRnC
    uint8_t stop_bits = 1;

    // Bits up to and with the first stop bit, which is the last one a receiver looks at.
    unsigned received_bits() const { return 1u + data_bits + (parity != 0 ? 1u : 0u) + 1u; }
    unsigned sent_bits() const { return received_bits() + stop_bits - 1u; }
    // The bits on the wire, first sent lowest.
    uint16_t encode(uint16_t data) const;
    bool parity_of(uint16_t data) const;
    void state(Archive& archive) {
        archive(data_bits, parity, stop_bits);
        archive.require(data_bits >= 5 && data_bits <= 9 && parity <= 3 && stop_bits >= 1 && stop_bits <= 2,
                        "its frames have a form that there is not");
    }
};

struct Sampling {
    double start;             // time of the first sample of the start bit
    double period;            // between samples
    unsigned samples_per_bit; // 16, or 8 at double speed

    // Time of the last of the three samples at the centre of bit `index` (0: the start bit).
    double decided(unsigned index) const {
        return start + period * (index * samples_per_bit + samples_per_bit / 2 + 1);
    }
    void state(Archive& archive) {
        archive(start, period, samples_per_bit);
        archive.require(start >= 0 && period > 0 && period <= 4096 &&
                            (samples_per_bit == 8 || samples_per_bit == 16),
                        "it samples as no receiver does");
    }
};

struct ReceivedFrame {
    uint16_t data = 0;
    bool started = false; // false: the start bit was a glitch, the rest means nothing
    bool framing_error = false;
    bool parity_error = false;
};

ReceivedFrame read_frame(const Line& line, const Sampling& sampling, const FrameFormat& format);

} // namespace tilenca::avr
