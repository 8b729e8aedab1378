// What inputs read that nobody drives: levels that change by chance, the same whenever and however often
// somebody looks.
#pragma once

#include "avr/archive.h"
#include "avr/cpu.h"
#include "avr/pin.h"

#include <cstdint>

namespace tilenca::avr {

class Noise {
  public:
    // Off, such inputs read high.
    void set(bool on, uint64_t seed) {
        is_on_ = on;
        seed_ = seed;
    }
    bool is_on() const { return is_on_; }

    // A port's eight pins at a moment.
    uint8_t levels(unsigned port, uint64_t cycle) const {
        return is_on_ ? of_window(port, cycle >> kWindowShift) : 0xFF;
    }
    bool level(PinId pin, uint64_t cycle) const { return (levels(pin.port, cycle) >> pin.bit & 1) != 0; }
    // The first moment after `cycle` and before `end` at which one of the pins in `mask` changes, or kNever.
    uint64_t next_change(unsigned port, uint8_t mask, uint64_t cycle, uint64_t end = kNever) const {
        uint64_t window = cycle >> kWindowShift;
        uint8_t before = is_on_ && mask != 0 ? of_window(port, window) : 0;
        for (unsigned looks = 0; is_on_ && mask != 0 && looks < kMostLooks; looks++) {
            const uint64_t begin = ++window << kWindowShift;
            if (begin >= end) {
                break;
            }
            const uint8_t now = of_window(port, window);
            if (((before ^ now) & mask) != 0) {
                return begin;
            }
            before = now;
        }
        return kNever;
    }
    void state(Archive& archive) { archive(seed_, is_on_); }

  private:
    // 64 us of 16 MHz: an edge every 128 us on average, and pulses that a USART takes for bits.
    static constexpr unsigned kWindowShift = 10;
    // So many windows without a change have never been.
    static constexpr unsigned kMostLooks = 4096;

    uint8_t of_window(unsigned port, uint64_t window) const {
        uint64_t z = seed_ + (window * kPorts + port) * 0x9E3779B97F4A7C15u; // splitmix64
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
        z = (z ^ z >> 27) * 0x94D049BB133111EBu;
        return static_cast<uint8_t>(z ^ z >> 31);
    }

    uint64_t seed_ = 0;
    bool is_on_ = false;
};

} // namespace tilenca::avr
