// Turns the times of a line's edges into bytes: the receiving half of the software UART.
//
// The interrupt only stores the time and the level of each edge. This class, which the main loop calls,
// samples the line in the middle of every bit, as a hardware UART does, but afterwards. It knows no pin and
// no timer.
#pragma once

#include <stdint.h>

namespace tilenca {

// `kBitCounts` is the length of a bit in counts of the timer that stamps the edges.
template <uint8_t kBitCounts>
class EdgeReceiver {
    static_assert(kBitCounts >= 8, "a bit has a middle");

  public:
    static constexpr int16_t kNoByte = -1;

    // Takes edges from the source until a byte is complete, and returns it. If there are no more edges, the
    // byte may be complete at the time `now`; otherwise returns kNoByte. Call it at least four times per turn
    // of the timer, or a byte without edges at its end waits for the next one.
    //
    // `source(&stamp)` gives the next edge, or false. Bit 0 of the stamp is the new level, the other bits are
    // the timer's count. `now` is not before the last stamp.
    template <typename Source>
    int16_t receive(Source source, uint16_t now);

    // How many bytes had no stop bit: the line was still low. Wraps.
    uint16_t framing_errors() const { return framing_errors_; }

    // Starts anew, after edges were lost or the line was noisy.
    void reset() { state_ = State(); }

  private:
    static constexpr uint8_t kStartBit = 0;
    static constexpr uint8_t kStopBit = 9;
    static constexpr uint8_t kIdle = 0xFF;
    static constexpr uint8_t kHigh = 0x80; // a bit as it enters a byte

    // Changes with every edge. The compiler keeps a copy of it in registers, as long as nothing takes its
    // address.
    struct State {
        uint8_t level = kHigh; // of the line since the last edge: kHigh or 0
        uint8_t bit = kIdle;   // next to be sampled: 0 the start bit, 1..8 data, 9 the stop bit
        uint8_t byte = 0;
        uint8_t framing_errors = 0; // of this call to receive()
        uint16_t sample_at = 0;     // the middle of that bit
    };

    static bool sample(State& state, uint16_t until);
    static bool change(State& state, uint16_t stamp);

    State state_;
    uint16_t framing_errors_ = 0;
};

// The level has stayed the same until this time. True if this completed state.byte.
template <uint8_t kBitCounts>
inline bool EdgeReceiver<kBitCounts>::sample(State& state, uint16_t until) {
    bool complete = false;
    int16_t since_sample = static_cast<int16_t>(until - state.sample_at);
    while (state.bit != kIdle && since_sample >= 0) {
        since_sample -= kBitCounts;
        if (state.bit == kStartBit) {
            state.bit = state.level ? kIdle : kStartBit + 1; // high again so soon: a glitch, no start bit
        } else if (state.bit < kStopBit) {
            state.byte = static_cast<uint8_t>(state.byte >> 1 | state.level);
            ++state.bit;
        } else {
            state.bit = kIdle;
            complete = state.level; // no stop bit: not a byte
            state.framing_errors += state.level == 0;
        }
    }
    state.sample_at = until - static_cast<uint16_t>(since_sample);
    return complete;
}

// The line has changed. True if this completed state.byte.
template <uint8_t kBitCounts>
inline bool EdgeReceiver<kBitCounts>::change(State& state, uint16_t stamp) {
    const uint8_t before = state.level;
    state.level = stamp & 1 ? kHigh : 0;
    if (state.level) {
        return false;
    }
    // A falling edge in the second half of the stop bit is already the next start bit: the sender is fast, or
    // stamps came late and early. The line was high, so the stop bit is good.
    const bool complete = state.bit == kStopBit && before;
    // If the line was low before, the rising edge between was missed.
    if (state.bit == kIdle || complete) {
        state.bit = kStartBit;
        state.sample_at = stamp + kBitCounts / 2;
    }
    return complete;
}

template <uint8_t kBitCounts>
template <typename Source>
inline int16_t EdgeReceiver<kBitCounts>::receive(Source source, uint16_t now) {
    State state = state_;
    bool complete = false;
    for (uint16_t stamp; !complete && source(&stamp);) {
        complete = sample(state, stamp);
        complete |= change(state, stamp);
    }
    if (!complete) {
        complete = sample(state, now);
    }
    if (state.framing_errors != 0) {
        framing_errors_ += state.framing_errors;
        state.framing_errors = 0;
    }
    state_ = state;
    return complete ? state.byte : kNoByte;
}

} // namespace tilenca
