#include "avr/frame_reader.h"

namespace tilenca::avr {

namespace {

// Machines convert to signed numbers only.
uint64_t whole(double cycles) {
    return static_cast<uint64_t>(static_cast<int64_t>(cycles));
}

// The bits must be asked for in order.
bool majority(Line::Levels& line, const Sampling& sampling, unsigned bit) {
    const double last = sampling.decided(bit);
    const bool first = line.at(whole(last - 2 * sampling.period));
    const uint64_t end = whole(last);
    if (line.stays_until(end)) {
        return first;
    }
    const bool second = line.at(whole(last - sampling.period)), third = line.at(end);
    return first + second + third >= 2;
}

} // namespace

bool FrameFormat::parity_of(uint16_t data) const {
    const bool odd = __builtin_parity(data);
    return parity == 3 ? !odd : odd;
}

uint16_t FrameFormat::encode(uint16_t data) const {
    unsigned at = 1; // after the start bit, a zero
    unsigned bits = (data & ((1u << data_bits) - 1)) << at;
    at += data_bits;
    if (parity != 0) {
        bits |= static_cast<unsigned>(parity_of(data & ((1u << data_bits) - 1))) << at++;
    }
    return static_cast<uint16_t>(bits | ((1u << stop_bits) - 1) << at);
}

ReceivedFrame read_frame(const Line& wire, const Sampling& sampling, const FrameFormat& format) {
    Line::Levels line(wire);
    ReceivedFrame frame;
    frame.started = !majority(line, sampling, 0);
    if (!frame.started) {
        return frame;
    }
    for (unsigned i = 0; i < format.data_bits; i++) {
        frame.data |= static_cast<uint16_t>(majority(line, sampling, i + 1) << i);
    }
    if (format.parity != 0) {
        frame.parity_error = majority(line, sampling, format.data_bits + 1u) != format.parity_of(frame.data);
    }
    frame.framing_error = !majority(line, sampling, format.received_bits() - 1);
    return frame;
}

} // namespace tilenca::avr
