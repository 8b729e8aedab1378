// Rendered by `tilenca export` from model D702; do not edit. Body a69f575039b119d8
#pragma once

#include <stdint.h>

#include "core/model.h"

namespace tilenca {
namespace model {

constexpr uint16_t kModelId = 0xD702;
constexpr uint8_t kChannels = 21;
constexpr uint8_t kHidden1 = 40;
constexpr uint8_t kHidden2 = 40;
constexpr uint8_t kClasses = 10; // 0 1 2 3 4 5 6 7 8 9

static_assert(kChannels <= kMaxChannels && kHidden1 <= kMaxHidden && kHidden2 <= kMaxHidden, "too wide");

extern const Model kModel;

} // namespace model
} // namespace tilenca
