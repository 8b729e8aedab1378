// What several suites need: shared case files, random numbers, tiles and cells of any size on the host.
#pragma once

#include <stdint.h>

#include <sstream>
#include <string>
#include <vector>

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
        : w1_(numbers.draw_all<int8_t>(hidden1 * 5 * channels, -reach, reach)),
          b1_(numbers.draw_all<int16_t>(hidden1, -128 * reach, 128 * reach)),
          w2_(numbers.draw_all<int8_t>(hidden2 * hidden1, -reach, reach)),
          b2_(numbers.draw_all<int16_t>(hidden2, -128 * reach, 128 * reach)),
          w3_(numbers.draw_all<int8_t>(channels * hidden2, -reach, reach)),
          b3_(numbers.draw_all<int16_t>(channels, -128 * reach, 128 * reach)), looks_(classes) {
        for (uint8_t k = 0; k < classes; ++k) {
            looks_[k] = {static_cast<char>('0' + k), k, k, k, k};
        }
    }

    Model model(uint16_t id = 0xBEEF) const {
        const uint8_t channels = static_cast<uint8_t>(b3_.size());
        const uint8_t hidden1 = static_cast<uint8_t>(b1_.size());
        const uint8_t hidden2 = static_cast<uint8_t>(b2_.size());
        const uint8_t inputs = static_cast<uint8_t>(kTaps * channels);
        const uint8_t classes = static_cast<uint8_t>(looks_.size());
        return {id,
                classes,
                {{inputs, hidden1, FlashView<int8_t>(w1_.data()), FlashView<int16_t>(b1_.data())},
                 {hidden1, hidden2, FlashView<int8_t>(w2_.data()), FlashView<int16_t>(b2_.data())},
                 {hidden2, channels, FlashView<int8_t>(w3_.data()), FlashView<int16_t>(b3_.data())}},
                FlashView<Look>(looks_.data())};
    }

  private:
    std::vector<int8_t> w1_;
    std::vector<int16_t> b1_;
    std::vector<int8_t> w2_;
    std::vector<int16_t> b2_;
    std::vector<int8_t> w3_;
    std::vector<int16_t> b3_;
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
