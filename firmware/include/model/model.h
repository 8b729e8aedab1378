// Rendered by `tilenca export` from model 79C0; do not edit. Body a092247df2cf5be2
#pragma once

#include <stdint.h>

#include "core/model.h"

namespace tilenca {
namespace model {

constexpr uint16_t kModelId = 0x79C0;
constexpr uint8_t kChannels = 21;
constexpr uint8_t kHidden1 = 40;
constexpr uint8_t kHidden2 = 40;
constexpr uint8_t kClasses = 10; // 0 1 2 3 4 5 6 7 8 9

static_assert(kChannels <= kMaxChannels && kHidden1 <= kMaxHidden && kHidden2 <= kMaxHidden, "too wide");

extern const Model kModel;

} // namespace model
} // namespace tilenca
