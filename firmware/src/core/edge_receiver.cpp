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
    // Copies, because a store to a member of one byte might, for all the compiler knows, change any other.
    const uint8_t high = level_ ? 0x80 : 0;
    const uint8_t bit_counts = bit_counts_;
    uint8_t bit = bit_;
    uint8_t byte = byte_;
    int16_t since_sample = static_cast<int16_t>(now - sample_at_);
    int16_t result = kNoByte;
    while (bit != kIdle && since_sample >= 0) {
        since_sample -= bit_counts;
        if (bit == kStartBit) {
            bit = high ? kIdle : kStartBit + 1; // high again so soon: a glitch, no start bit
        } else if (bit < kStopBit) {
            byte = static_cast<uint8_t>(byte >> 1 | high);
            ++bit;
        } else {
            bit = kIdle;
            result = high ? byte : kNoByte; // no stop bit: not a byte
        }
    }
    bit_ = bit;
    byte_ = byte;
    sample_at_ = now - static_cast<uint16_t>(since_sample);
    return result;
}

void EdgeReceiver::reset() {
    level_ = true;
    bit_ = kIdle;
}

} // namespace tilenca
