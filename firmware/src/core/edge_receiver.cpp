#include "core/edge_receiver.h"

namespace tilenca {

namespace {

constexpr uint8_t kStartBit = 0;
constexpr uint8_t kStopBit = 9;

} // namespace

int16_t EdgeReceiver::edge(uint16_t stamp) {
    int16_t byte = poll(stamp);
    const bool was_high = level_;
    level_ = stamp & 1;
    if (bit_ == kStopBit && was_high && !level_) {
        // The next start bit, though half of the stop bit is still due: a fast sender, or a stamp that came
        // late before one that came early. The line was high, which is all a stop bit has to say.
        byte = byte_;
        bit_ = kIdle;
    }
    // Even if it was low before: then the edge between was missed, and the line has fallen again.
    if (bit_ == kIdle && !level_) {
        bit_ = kStartBit;
        sample_at_ = stamp + bit_counts_ / 2;
    }
    return byte;
}

int16_t EdgeReceiver::poll(uint16_t now) {
    while (bit_ != kIdle && static_cast<int16_t>(now - sample_at_) >= 0) {
        sample_at_ += bit_counts_;
        if (bit_ == kStartBit) {
            bit_ = level_ ? kIdle : kStartBit + 1; // high again so soon: a glitch, no start bit
        } else if (bit_ < kStopBit) {
            byte_ = static_cast<uint8_t>(byte_ >> 1 | level_ << 7);
            ++bit_;
        } else {
            bit_ = kIdle;
            return level_ ? byte_ : kNoByte; // no stop bit: not a byte
        }
    }
    return kNoByte;
}

} // namespace tilenca
