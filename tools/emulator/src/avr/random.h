// A small generator of random numbers that gives the same ones on every machine (splitmix64).
#pragma once

#include "avr/archive.h"

#include <cstdint>

namespace tilenca::avr {

class Random {
  public:
    explicit Random(uint64_t seed = 0) : state_(seed) {}

    uint64_t next() {
        uint64_t z = state_ += 0x9E3779B97F4A7C15u;
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
        z = (z ^ z >> 27) * 0x94D049BB133111EBu;
        return z ^ z >> 31;
    }
    // 0 <= it < 1.
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    // Mean 0, deviation 1; a sum of twelve needs no library function that could differ in its last bit.
    double normal() {
        double sum = -6;
        for (int i = 0; i < 12; i++) {
            sum += uniform();
        }
        return sum;
    }
    void state(Archive& archive) { archive(state_); }

  private:
    uint64_t state_;
};

} // namespace tilenca::avr
