// Weights as product.h wants them.
#pragma once

#include <stddef.h>

#include <vector>

#include "lanes.h"
#include "product.h"

namespace rollout {
namespace { // see lanes.h

inline int padded(int width) {
    return (width + kPadding - 1) / kPadding * kPadding;
}

// A copy of a dense matrix, rows padded with zeros; transposed if wanted.
class Packed {
  public:
    Packed(const float* values, int rows, int columns, bool transposed)
        : depth_(transposed ? columns : rows), width_(padded(transposed ? rows : columns)),
          values_(static_cast<size_t>(depth_) * width_) {
        for (int r = 0; r < rows; ++r) {
            for (int c = 0; c < columns; ++c) {
                const size_t row = transposed ? c : r, column = transposed ? r : c;
                values_[row * width_ + column] = values[static_cast<size_t>(r) * columns + c];
            }
        }
    }

    Matrix matrix() const { return {values_.data(), depth_, width_ / kWidth}; }

  private:
    int depth_;
    int width_;
    std::vector<float> values_;
};

// A bias of every output with `more` added, padded with zeros.
inline std::vector<float> padded_bias(const float* values, int count, float more) {
    std::vector<float> bias(padded(count));
    for (int i = 0; i < count; ++i) {
        bias[i] = values[i] + more;
    }
    return bias;
}

} // namespace
} // namespace rollout
