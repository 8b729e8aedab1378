// The steps of the board test. Some of them light one lamp after the other.
#pragma once

#include <stdint.h>

namespace tilenca {

enum class Step : uint8_t { Segments, Leds, Colours, Sides };
constexpr uint8_t kSteps = 4;

constexpr uint8_t kDuty = 60; // bright enough to see, and not too bright to look at

// How many lamps a step lights in turn; 0: none.
uint8_t lamps_of(Step step);

// Lights only this lamp, and names it to the host.
void light(Step step, uint8_t lamp);

} // namespace tilenca
