// rows x matrix, with something done to every result before it is stored.
#pragma once

#include "lanes.h"

namespace rollout {
namespace { // compiled several times over for different processors: each file has its own

// A matrix of `depth` rows of `vectors` * kWidth floats, without gaps.
struct Matrix {
    const float* values;
    int depth;
    int vectors;
};

// R rows by V vectors kept in registers: out[r] = finish(rows[r] * matrix, r, column).
template <int R, int V, typename Finish>
inline void product_tile(const float* rows, size_t stride, const float* matrix, int depth, int width,
                         Finish finish) {
    Lanes sums[R][V] = {};
    for (int k = 0; k < depth; ++k) {
        Lanes weights[V];
        for (int v = 0; v < V; ++v) {
            weights[v] = load(matrix + static_cast<size_t>(k) * width + v * kWidth);
        }
        for (int r = 0; r < R; ++r) {
            const float input = rows[r * stride + k];
            for (int v = 0; v < V; ++v) {
                sums[r][v] += input * weights[v];
            }
        }
    }
#pragma GCC unroll 24
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
        for (int v = 0; v < V; ++v) {
            finish(sums[r][v], r, v * kWidth);
        }
    }
}

template <int V, int R, typename Finish>
inline void product_rows(const float* rows, size_t stride, size_t count, const float* matrix, int depth,
                         int width, Finish finish) {
    size_t row = 0;
    for (; row + R <= count; row += R) {
        product_tile<R, V>(rows + row * stride, stride, matrix, depth, width,
                           [&](Lanes sum, int r, int column) { finish(sum, row + r, column); });
    }
    if constexpr (R > 1) {
        if (row < count) {
            product_rows<V, R - 1>(rows + row * stride, stride, count - row, matrix, depth, width,
                                   [&](Lanes sum, size_t r, int column) { finish(sum, row + r, column); });
        }
    }
}

// finish(sum, row, column) for `count` rows of `stride` floats times the matrix, kWidth columns at a time.
template <typename Finish>
inline void product(const float* rows, size_t stride, size_t count, const Matrix& matrix, Finish finish) {
    constexpr int kMost = 4; // vectors side by side: their weights are loaded once for several rows
    const int width = matrix.vectors * kWidth;
    int done = 0;
    while (done < matrix.vectors) {
        const int left = matrix.vectors - done;
        const float* values = matrix.values + done * kWidth;
        const auto shifted = [&](Lanes sum, size_t row, int column) {
            finish(sum, row, done * kWidth + column);
        };
        if (left >= kMost) {
            product_rows<4, kSums / 4>(rows, stride, count, values, matrix.depth, width, shifted);
            done += 4;
        } else if (left == 3) {
            product_rows<3, kSums / 3>(rows, stride, count, values, matrix.depth, width, shifted);
            done += 3;
        } else if (left == 2) {
            product_rows<2, kSums / 3>(rows, stride, count, values, matrix.depth, width, shifted);
            done += 2;
        } else {
            product_rows<1, kSums / 3>(rows, stride, count, values, matrix.depth, width, shifted);
            done += 1;
        }
    }
}

} // namespace
} // namespace rollout
