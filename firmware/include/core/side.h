// The four sides of a tile, in the order every table uses: N E S W.
#pragma once

#include <stdint.h>

namespace tilenca {

enum class Side : uint8_t { North, East, South, West };

constexpr uint8_t kSides = 4;
constexpr char kSideLetters[] = "NESW";

constexpr uint8_t index_of(Side side) {
    return static_cast<uint8_t>(side);
}

constexpr Side side_at(uint8_t index) {
    return static_cast<Side>(index);
}

constexpr Side opposite(Side side) {
    return static_cast<Side>((index_of(side) + 2) % kSides);
}

} // namespace tilenca
