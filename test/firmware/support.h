// What several suites need: shared case files, random numbers, tiles and cells of any size on the host.
#pragma once

#include <stdint.h>

#include <sstream>
#include <string>
#include <vector>

#include "../../tools/simulator/layer_stream.h"
#include "core/model.h"

namespace tilenca {
namespace test {

// The numbers of `Numbers` in test/vectors/make_vectors.py: xorshift32.
class Numbers {
  public:
    explicit Numbers(uint32_t seed) : state_(seed) {}

    // low..high
    int32_t draw(int32_t low, int32_t high) {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 17;
        state_ ^= state_ << 5;
        return low + static_cast<int32_t>(state_ % static_cast<uint32_t>(high - low + 1));
    }

    bool chance(int32_t percent) { return draw(0, 99) < percent; }

    template <typename T>
    std::vector<T> draw_all(size_t count, int32_t low, int32_t high) {
        std::vector<T> values(count);
        for (T& value : values) {
            value = static_cast<T>(draw(low, high));
        }
        return values;
    }

  private:
    uint32_t state_;
};

// A model with random weights of up to +-reach and biases of up to 128 times that.
class RandomModel {
  public:
    RandomModel(uint8_t channels, uint8_t hidden1, uint8_t hidden2, uint8_t classes, Numbers& numbers,
                int32_t reach)
        : hidden1_(random_layer(5 * channels, hidden1, numbers, reach)),
          hidden2_(random_layer(hidden1, hidden2, numbers, reach)),
          output_(random_layer(hidden2, channels, numbers, reach)), looks_(classes) {
        for (uint8_t k = 0; k < classes; ++k) {
            looks_[k] = {static_cast<char>('0' + k), k, k, k, k};
        }
    }

    Model model(uint16_t id = 0xBEEF) const {
        return {id,
                static_cast<uint8_t>(looks_.size()),
                {hidden1_.layer(), hidden2_.layer(), output_.layer()},
                FlashView<Look>(looks_.data()),
                0};
    }

  private:
    static LayerStream random_layer(int inputs, int outputs, Numbers& numbers, int32_t reach) {
        const auto weights = numbers.draw_all<int8_t>(outputs * inputs, -reach, reach);
        const auto biases = numbers.draw_all<int16_t>(outputs, -128 * reach, 128 * reach);
        return LayerStream(static_cast<uint8_t>(inputs), static_cast<uint8_t>(outputs), weights.data(),
                           biases.data());
    }

    LayerStream hidden1_;
    LayerStream hidden2_;
    LayerStream output_;
    std::vector<Look> looks_;
};

inline std::vector<uint8_t> bytes_of_hex(const std::string& hex) {
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

inline std::string joined(const std::vector<std::string>& words, const char* separator) {
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : separator) + word;
    }
    return text;
}

} // namespace test
} // namespace tilenca
