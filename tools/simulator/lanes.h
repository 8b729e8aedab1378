// Many cells side by side, as the arithmetic of the firmware's core wants its `Lanes` (core/arithmetic.h).
//
// kRows outputs of W cells go together. Sums are float32, which holds every whole number up to 2^24, and none
// here reaches 2^23: additions in any order, fused or not, give the chip's integers, twice as fast as int32
// does.
#pragma once

#include <stdint.h>

namespace tilenca {

constexpr int kRows = 8; // enough independent sums to keep two multipliers busy

template <int W>
struct Lanes {
    typedef float Floats __attribute__((vector_size(4 * W)));
    typedef int32_t Integers __attribute__((vector_size(4 * W)));

    struct Sum {
        Floats row[kRows];
    };
    struct Whole {
        Integers row[kRows];
    };
    using Outputs = Sum;
    using State = Whole;

    template <class Rows, class Function>
    static Rows each(Function value_of_row) {
        Rows rows;
#pragma GCC unroll 8
        for (int r = 0; r < kRows; ++r) {
            rows.row[r] = value_of_row(r);
        }
        return rows;
    }

    static Sum sum(const float* biases) {
        return each<Sum>([=](int r) { return Floats{} + biases[r]; });
    }
    static void multiply_add(Sum& sum, const float* weights, const Floats& input) {
#pragma GCC unroll 8
        for (int r = 0; r < kRows; ++r) {
            sum.row[r] += weights[r] * input;
        }
    }
    static Whole whole(const Sum& sum) {
        return each<Whole>([&](int r) { return __builtin_convertvector(sum.row[r], Integers); });
    }
    static Whole clamp(const Whole& values, int32_t low, int32_t high) {
        return each<Whole>([&](int r) {
            const Integers x = values.row[r] < low ? Integers{} + low : values.row[r];
            return x > high ? Integers{} + high : x;
        });
    }
    static Outputs outputs(const Whole& values) {
        return each<Sum>([&](int r) { return __builtin_convertvector(values.row[r], Floats); });
    }
    static State state(const Whole& values) { return values; }

    friend Whole operator+(const Whole& a, const Whole& b) {
        return each<Whole>([&](int r) { return a.row[r] + b.row[r]; });
    }
    friend Whole operator+(const Whole& a, int32_t b) {
        return each<Whole>([&](int r) { return a.row[r] + b; });
    }
    friend Whole operator>>(const Whole& a, int bits) {
        return each<Whole>([&](int r) { return a.row[r] >> bits; });
    }
};

} // namespace tilenca
