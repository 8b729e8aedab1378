// Vectors of floats as wide as the processor that this file is compiled for has them.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "tilenca/rollout.h"

namespace rollout {
namespace { // compiled several times over for different processors: each file has its own

#if defined(__AVX512F__)
constexpr int kWidth = 16;
constexpr int kSums = 24; // vectors that a tile of a product may keep in registers
#elif defined(__AVX__)
constexpr int kWidth = 8;
constexpr int kSums = 12;
#else
constexpr int kWidth = 4;
constexpr int kSums = 12;
#endif

constexpr int kPadding = TILENCA_ROLLOUT_PADDING; // floats, for rows of matrices, too, whatever the processor

using Lanes = float __attribute__((vector_size(kWidth * sizeof(float)), aligned(4), may_alias));
using Whole = int32_t __attribute__((vector_size(kWidth * sizeof(float))));

inline Lanes load(const float* from) {
    return *reinterpret_cast<const Lanes*>(from);
}

inline void store(float* to, Lanes value) {
    *reinterpret_cast<Lanes*>(to) = value;
}

// Largest whole number not above, NaN for NaN; sizes must stay below 2^31.
inline Lanes floor(Lanes value) {
    const Lanes cut = __builtin_convertvector(__builtin_convertvector(value, Whole), Lanes);
    const Lanes nothing = value - value; // NaN for NaN, which has no whole number
    return cut - (cut > value ? Lanes{} + 1.0f : Lanes{}) + nothing;
}

inline Lanes clamp(Lanes value, float low, float high) {
    const Lanes lows = Lanes{} + low;
    const Lanes highs = Lanes{} + high;
    value = value < lows ? lows : value;
    return value > highs ? highs : value;
}

// `gradient` where the clamp did not cut, else zero.
inline Lanes through_clamp(Lanes gradient, Lanes clamped, float low, float high) {
    const Lanes inside = clamped > Lanes{} + low ? gradient : Lanes{};
    return clamped < Lanes{} + high ? inside : Lanes{};
}

} // namespace
} // namespace rollout
