// Turns the times of a line's edges into bytes: the receiving half of the software UART.
//
// The interrupt only stores when the line changed and to what; the work is done here, outside it. The line is
// sampled at the middle of every bit, as a hardware UART does, only afterwards. Knows no pin and no timer.
#pragma once

#include <stdint.h>

namespace tilenca {

class EdgeReceiver {
  public:
    static constexpr int16_t kNoByte = -1;

    // `bit_counts`: length of a bit in counts of the timer that stamps the edges, at least 8.
    explicit EdgeReceiver(uint8_t bit_counts) : bit_counts_(bit_counts) {}

    // The line changed. Bit 0 of the stamp is the new level, the others are the timer's count. Returns the
    // byte that this completed, or kNoByte.
    int16_t edge(uint16_t stamp);

    // No further edge came until `now`. Returns the byte that this completed, or kNoByte. Call it at least
    // four times per turn of the timer, or a byte without edges at its end waits for the next one.
    int16_t poll(uint16_t now);

    // Forgets what it has heard: edges were lost, or the line is not to be believed.
    void reset();

  private:
    static constexpr uint8_t kIdle = 0xFF;

    uint8_t bit_counts_;
    bool level_ = true;   // of the line since the last edge
    uint8_t bit_ = kIdle; // next to be sampled: 0 the start bit, 1..8 data, 9 the stop bit
    uint8_t byte_ = 0;
    uint16_t sample_at_ = 0; // the middle of that bit
};

} // namespace tilenca
