// Rendered by `tilenca export` from model F9FA; do not edit. Body b91abcc8bb001d98
#pragma once

#include <stdint.h>

#include "core/model.h"

namespace tilenca {
namespace model {

constexpr uint16_t kModelId = 0xF9FA;
constexpr uint8_t kChannels = 24;
constexpr uint8_t kHidden1 = 96;
constexpr uint8_t kHidden2 = 96;
constexpr uint8_t kDirections = 0;
constexpr uint8_t kClasses = 11; // 0 1 2 3 4 5 6 7 8 9 -

static_assert(kChannels <= kMaxChannels && kHidden1 <= kMaxHidden && kHidden2 <= kMaxHidden, "too wide");

extern const Model kModel;

} // namespace model
} // namespace tilenca
